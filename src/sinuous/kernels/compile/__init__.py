"""How kernels become machine code: the one door to it, and what is done to Numba.

Kernels are plain Python functions of numbers, tuples and arrays. `@entry` marks those that Python calls; what these
call needs no mark. Numba alone would compile them, and `SINUOUS_COMPILER=numba` lets it: 220 s of CPU for the first
solve among obstacles, where this takes 60, and nothing to show until then. So there are five additions, each of which
can be left by itself.

**Functions stay functions** (`marks`). A decorated kernel would be a dispatcher, which no debugger enters and which
Python calls slowly. Here Numba is told what is compiled for a function when it meets one (`typeof_impl`, public), and
`@entry` returns a dispatcher. `@shared`, `@apart` and `@inline` say where machine code goes. To leave it, decorate all
kernels with `numba.njit`.

**Linked once** (`once`). Numba links, optimises and emits each function with all its callees, and does so again in each
of their callers. Here a kernel is lowered, and the entry, or a shared kernel, links, optimises and emits all of it.
Overridden: `Compiler.define_pipelines` (passes that kernels have no use for are left out), the methods `finalize`,
`add_ir_module` and `_optimize_final_module` of `JITCodeLibrary`, and `Lower` for variables that live in registers.

**Lean calls** (also `once`). Numba hands over seven fields of every array and an error code. Kernels own no memory and
raise nothing, so an array is its address and shape, and a result comes back as a value. Overridden: the call convention
(`CPUCallConv`), the data model of arrays, `CPUContext`. Goes with the above; leaving both is `SINUOUS_COMPILER=numba`.

**A store** (`store`, `sources`, `targets`, `locks`). Numba's cache looks at one file, and misses a change in a callee
that lives in another. A file of ours is named by a hash of all sources that a function imports, of the compilers and of
the processor, so that checkouts and environments share one folder, and wheels can ship code. In the place of a
dispatcher's `_cache`. To leave it, set `cache=True`.

**Answers before code** (`interpreting`, `tiers`, `helpers`). An entry without code runs as Python, made of
the same lines, with the arithmetic of machine code; processes of the lowest priority compile meanwhile; a call ends as
Python, or is made again once its code is there. A dispatcher asks `_compile_for_args` where it has no code, and that is
overridden. `SINUOUS_KERNELS` says how entries run: `auto` is this, `compiled` waits for code, `interpreted` compiles
nothing.

`SINUOUS_COMPILER` is `linked`, all of the above, or `numba`: `numba.njit` with options that its manual has, without
`once`; code is still kept in the store, where that Numba lets it, and what is slow to come is still
interpreted meanwhile. By default it is `linked` with the versions of Numba in `sources.TRIED`, and `numba` with others,
so that a new Numba works, slowly at first; `sinuous warm` says so. To try one, run the tests with it and
`SINUOUS_COMPILER=linked`, and list it.

Whoever changes how code comes about raises `sources.VERSION`: the text of these files does not count for what is kept.
"""

from sinuous.kernels.compile.helpers import cores as cores
from sinuous.kernels.compile.marks import apart as apart
from sinuous.kernels.compile.marks import compiled_form as compiled_form
from sinuous.kernels.compile.marks import entry as entry
from sinuous.kernels.compile.marks import entry_around as entry_around
from sinuous.kernels.compile.marks import inline as inline
from sinuous.kernels.compile.marks import interpret_all as interpret_all
from sinuous.kernels.compile.marks import interpreted_as as interpreted_as
from sinuous.kernels.compile.marks import intrinsic as intrinsic
from sinuous.kernels.compile.marks import kernel as kernel
from sinuous.kernels.compile.marks import shared as shared
from sinuous.kernels.compile.sources import sources_hash as sources_hash
from sinuous.kernels.compile.tiers import code_first as code_first
