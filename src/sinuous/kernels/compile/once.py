"""Optimise every entry once, together with all that it calls, and let kernels call each other without ceremony.

For each kernel Numba links all its callees, optimises the whole, emits machine code, and does so again in each of its
callers. Here a kernel stays a `LoweredKernel`, as Numba lowers it, and the entry, a `Whole`, links, optimises and
emits. A kernel that is shared is a `Whole`, too: those that call it find its machine code by its name.

Numba also hands over seven fields of every array and more of larger ones, has each result written to memory, and asks
after each call whether something was raised: half of what LLVM was given. Kernels own no array and raise nothing. So
between them an array is its address and shape, and what is returned comes back. What Numba brings itself is called as
ever, and so are entries by Python.

Of Numba this takes the hook that lets a function have a compiler of its own (`pipeline_class`), and the methods of its
`JITCodeLibrary` and `Lower` that are overridden below. What changes the code that comes out raises `sources.VERSION`.
"""

import copy
from collections import defaultdict
from functools import cache
from typing import Any

from llvmlite import binding as llvm
from llvmlite import ir
from numba.core import config as numba_config
from numba.core import types
from numba.core.analysis import compute_cfg_from_blocks, compute_use_defs, must_use_alloca
from numba.core.callconv import CPUCallConv
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.cpu import CPUContext
from numba.core.datamodel import models, registry
from numba.core.datamodel.packer import ArgPacker
from numba.core.ir import Assign
from numba.core.lowering import Lower
from numba.core.typed_passes import NativeLowering
from numba.np.numpy_support import as_dtype

COUNT, ITEM_SIZE, DATA, SHAPE, STRIDES = 2, 3, 4, 5, 6
"""Fields of Numba's arrays; those before them belong to who counts references."""

NUMBER = ir.IntType(64)


class _Array(models.ArrayModel):
    """An array that is handed over by its address and shape, and by its strides where they do not follow from these."""

    @property
    def _fields_given(self) -> tuple[int, ...]:
        return (SHAPE,) if self._fe_type.layout == "C" else (SHAPE, STRIDES)

    def get_argument_type(self) -> Any:
        sizes = (NUMBER,) * self._fe_type.ndim
        return self.get_value_type().elements[DATA], *(sizes for _ in self._fields_given)

    def as_argument(self, builder: Any, value: Any) -> Any:
        data = builder.extract_value(value, DATA)
        axes = range(self._fe_type.ndim)
        return data, *(tuple(builder.extract_value(value, [each, i]) for i in axes) for each in self._fields_given)

    def from_argument(self, builder: Any, value: Any) -> Any:
        data, shape, *rest = value
        item_size = int(as_dtype(self._fe_type.dtype).itemsize)
        strides = list(rest[0]) if rest else [NUMBER(item_size)]
        while len(strides) < len(shape):
            strides.insert(0, builder.mul(shape[len(shape) - len(strides)], strides[0]))
        count = shape[0] if shape else NUMBER(1)
        for size in shape[1:]:
            count = builder.mul(count, size)
        whole = self.get_value_type()
        fields = [ir.Constant(each, None) for each in whole.elements]
        fields[ITEM_SIZE] = NUMBER(item_size)
        array = builder.insert_value(ir.Constant(whole, fields), count, COUNT)
        array = builder.insert_value(array, data, DATA)
        for field, numbers in ((SHAPE, shape), (STRIDES, strides)):
            for i, number in enumerate(numbers[: len(shape)]):
                array = builder.insert_value(array, number, [field, i])
        return array


MODELS = registry.default_manager.copy()
MODELS.register(types.Array, _Array)


@cache
def _packer(given: tuple[Any, ...]) -> Any:
    """Return what makes numbers of arguments of these types, and arguments of numbers."""
    return ArgPacker(MODELS, given)


def _in_memory(returned: Any) -> bool:
    """Say whether a result of this type is written where the caller says: LLVM returns single numbers well."""
    return isinstance(MODELS[returned].get_value_type(), ir.Aggregate)


def declared(module: Any, kernel: Any) -> Any:
    """Return the function of a `kernel`, as Numba describes it, within a module."""
    found = module.globals.get(kernel.mangled_name)
    if found is not None:
        return found
    returned, given = MODELS[kernel.restype].get_value_type(), list(_packer(kernel.argtypes).argument_types)
    if _in_memory(kernel.restype):
        given, returned = [returned.as_pointer(), *given], ir.VoidType()
    elif kernel.restype == types.none:
        returned = ir.VoidType()
    function = ir.Function(module, ir.FunctionType(returned, given), kernel.mangled_name)
    if _in_memory(kernel.restype):
        function.args[0].add_attribute("noalias")
    if kernel.inline:
        function.attributes.add("alwaysinline")
    return function


def call_of(kernel: Any, library: Any) -> Any:
    """Return what writes a call of a `kernel`, as Numba describes it, whose code is in a library."""

    def write(context: Any, builder: Any, _: Any, arguments: Any) -> Any:
        function = declared(builder.module, kernel)
        given = _packer(kernel.argtypes).as_arguments(builder, arguments)
        if not _in_memory(kernel.restype):
            made = builder.call(function, given)
            return context.get_dummy_value() if kernel.restype == types.none else made
        with builder.goto_entry_block():
            place = builder.alloca(function.args[0].type.pointee)
        builder.call(function, (place, *given))
        return builder.load(place)

    write.signature, write.libs = kernel.argtypes, (library,)  # type: ignore[attr-defined]  # as Numba asks for
    return write


def call_leanly(context: Any, compiled: Any) -> None:
    """Let all that Numba compiles call a kernel that was compiled as it is to be called."""
    call = call_of(compiled.fndesc, compiled.library)
    context.remove_user_function(compiled.entry_point)
    context.insert_func_defn([(call, compiled.entry_point, call.signature)])


class _Within(CPUCallConv):
    """How a kernel that returns such a type finds its arguments, and returns."""

    def __init__(self, context: Any, returned: Any) -> None:
        super().__init__(context)
        self._returned = returned

    def decode_arguments(self, builder: Any, argtypes: Any, func: Any) -> Any:
        return _packer(argtypes).from_arguments(builder, func.args[_in_memory(self._returned) :])

    def return_value(self, builder: Any, retval: Any) -> None:
        if _in_memory(self._returned):
            builder.store(retval, builder.function.args[0])
            builder.ret_void()
        elif self._returned == types.none:
            builder.ret_void()
        else:
            builder.ret(retval)

    def return_optional_value(self, builder: Any, retty: Any, valty: Any, value: Any) -> None:
        self.return_value(builder, self.context.cast(builder, value, valty, retty))

    def return_user_exc(self, builder: Any, *_: Any, **__: Any) -> None:
        self._give_up(builder)

    def return_status_propagate(self, builder: Any, status: Any) -> None:
        self._give_up(builder)

    def _give_up(self, builder: Any) -> None:
        """Return, with zeros, where Python raises: machine code of kernels goes on."""
        self.return_value(builder, ir.Constant(MODELS[self._returned].get_value_type(), None))


class _Context(CPUContext):
    """Where the body of a kernel is written that returns such a type; what Numba adds is compiled outside of it."""

    outside: CPUContext
    returned: Any

    @property
    def call_conv(self) -> Any:
        return _Within(self, self.returned)

    def compile_subroutine(self, *arguments: Any, **settings: Any) -> Any:
        return self.outside.compile_subroutine(*arguments, **settings)

    def get_return_value(self, builder: Any, ty: Any, val: Any) -> Any:
        return val


def within(context: Any, kernel: Any) -> Any:
    """Return where the body of a `kernel`, as Numba describes it, is written."""
    own = copy.copy(context)
    own.__class__, own.outside, own.returned = _Context, context, kernel.restype
    return own


config: Any = numba_config  # its settings are made at run time, which a type checker does not see

NEEDLESS = {
    "AnnotateTypes",
    "DumpParforDiagnostics",
    "FindLiterallyCalls",
    "InlineClosureLikes",
    "InlineOverloads",
    "LiteralPropagationSubPipelinePass",
    "LiteralUnroll",
    "MakeFunctionToJitFunction",
    "NopythonRewrites",
    "RewriteDynamicRaises",
}
"""Passes of Numba's front end that kernels have no use for: closures, generators, array expressions, reports."""

ENVIRONMENT = "_ZN08NumbaEnv"
"""What names of Numba's environments begin with."""


class _Library(JITCodeLibrary):
    """Code that is optimised when all of it is there, not as it comes.

    Attributes
    ----------
    parts : list of LoweredKernel or Whole
        Of a part, the kernels that it calls; of a whole, the shared kernels whose machine code it calls.
    """

    parts: "list[LoweredKernel | Whole]"
    _filled = False

    def add_ir_module(self, ir_module: Any) -> None:
        """Take a module over as it is."""
        self._raise_if_finalized()
        module = llvm.parse_assembly(str(ir_module))
        module.data_layout = self._codegen._data_layout
        if self._filled:
            self._final_module.link_in(module)
        else:
            module.name = self._final_module.name
            self._final_module, self._filled = module, True

    def serialize_using_object_code(self) -> Any:
        """Return what is kept on disk: this alone."""
        return self.name, "object", (self._get_compiled_object(), self._get_module_for_linking().as_bitcode())


class LoweredKernel(_Library):
    """A kernel as Numba lowers it, neither optimised nor machine code."""

    _shared_module: Any
    _attributes: tuple[str, ...] = ()

    def finalize(self) -> None:
        """Keep what entries link; give the engine nothing but Numba's environment, for which it asks."""
        whole = self._final_module
        own = {function.name for function in whole.functions if function.linkage == llvm.Linkage.external}
        self.parts = []
        for library in dict.fromkeys(self._linking_libraries):
            if isinstance(library, LoweredKernel | Whole):
                self.parts.append(library)
            else:
                whole.link_in(library._get_module_for_linking(), preserve=True)
        for function in whole.functions:
            if not function.is_declaration and function.name not in own:
                # Another process may have given its name to another helper of Numba: nobody sees it.
                function.linkage = "private"
        self._lighten(whole)
        for name in own:
            whole.get_function(name).linkage = "linkonce_odr"
            for attribute in self._attributes:
                whole.get_function(name).add_function_attribute(attribute)
        self._finalize_dynamic_globals()
        self._shared_module = whole
        self._final_module = llvm.parse_assembly(str(self._codegen._create_empty_module(self.name)) + _seen(whole))
        self._final_module.name = whole.name
        self._finalize_final_module()

    def _lighten(self, module: Any) -> None:
        """Take out what was lowered in vain: addresses of this process among it, which cannot be kept on disk."""
        passes = llvm.create_new_module_pass_manager()
        passes.add_dead_code_elimination_pass()
        passes.add_global_dead_code_eliminate_pass()
        passes.run(module, llvm.create_pass_builder(self._codegen._tm, llvm.create_pipeline_tuning_options(1)))


class Apart(LoweredKernel):
    """A kernel that is not copied into what calls it."""

    _attributes = ("noinline",)


class Whole(_Library):
    """An entry, or a kernel that is shared, with all that it calls, optimised at once."""

    def finalize(self) -> None:
        """Link all parts, each once."""
        found = reached(self._linking_libraries)
        self.parts = [one for one in found if isinstance(one, Whole)]
        modules = [one._shared_module.clone() for one in found if isinstance(one, LoweredKernel)]
        if modules:
            self._final_module.link_in(_joined(modules))
        self._linking_libraries = [one for one in self._linking_libraries if not isinstance(one, LoweredKernel | Whole)]
        super().finalize()

    def _optimize_final_module(self) -> None:
        """Optimise once; what was linked belongs to this entry alone.

        Its arguments may change, and what is called once moves into its caller. So nobody else may be given it by its
        name, as the engine would give it: private functions have none in the machine code.
        """
        for number, function in enumerate(list(self._final_module.functions)):
            if function.is_declaration:
                if function.name.startswith("_ZN") and not self._codegen._engine.is_symbol_defined(function.name):
                    raise AssertionError(f"{function.name} is not there to be linked")
            elif function.linkage != llvm.Linkage.external:
                function.linkage = "private"
                function.name = f"{self.name}.{number}.{function.name}"
        options = llvm.create_pipeline_tuning_options(int(config.OPT))
        options.loop_vectorization, options.slp_vectorization = True, False
        builder = llvm.create_pass_builder(self._codegen._tm, options)
        builder.getModulePassManager().run(self._final_module, builder)


class Shared(Whole):
    """A kernel that is machine code of its own."""


LIBRARIES = {"inner": LoweredKernel, "apart": Apart, "shared": Shared, "entry": Whole}
"""Into which library each kind of function is compiled."""

KERNELS = LoweredKernel, Shared
"""Libraries of what kernels call, as `calls` says."""


def reached(libraries: list[Any]) -> list[LoweredKernel | Whole]:
    """List the parts among these libraries, and all that they call in turn, each once: of shared ones those alone."""
    found: dict[LoweredKernel | Whole, None] = {}
    due = [library for library in reversed(libraries) if isinstance(library, LoweredKernel | Whole)]
    while due:
        one = due.pop()
        if one not in found:
            found[one] = None
            due += one.parts if isinstance(one, LoweredKernel) else ()
    return list(found)


def _joined(modules: list[Any]) -> Any:
    """Link modules, two by two: to add one LLVM goes through all that is there already."""
    for module in modules:
        for function in module.functions:
            if function.linkage == llvm.Linkage.linkonce_odr:  # of which only what is called so far would be linked
                function.linkage = "weak_odr"
    while len(modules) > 1:
        for module, other in zip(modules[::2], modules[1::2], strict=False):
            module.link_in(other)
        modules = modules[::2]
    return modules[0]


def as_was(library: Any, kind: str, parts: list[LoweredKernel | Whole]) -> None:
    """Let a library that was read from the disk be of the kind that it was, which calls these others."""
    library.__class__ = LIBRARIES[kind]
    library.parts = parts


class _Lower(Lower):
    """Writes what kernels need, and no more.

    Variables are not set to zero before and after they live, which serves counting of references alone. Nor does anyone
    ask how large each is, which serves debuggers alone: Numba prints and parses the type to find out, and those of
    tuples of arrays are long.
    """

    def init(self) -> None:
        super().init()
        if isinstance(self.library, KERNELS):
            self.context = within(self.context, self.fndesc)

    def _find_singly_assigned_variable(self) -> None:
        """Find the variables that are values of LLVM: assigned once, before all uses. Numba's end with their block."""
        super()._find_singly_assigned_variable()
        blocks = self.func_ir.blocks
        alloca, assigned, used = must_use_alloca(blocks), defaultdict(list), defaultdict(set)
        for label, block in blocks.items():
            for statement in block.find_insts(Assign):
                assigned[statement.target.name].append(label)
        for label, names in compute_use_defs(blocks).usemap.items():
            for name in names:
                used[name].add(label)
        before = compute_cfg_from_blocks(blocks).dominators()
        for name, (label, *others) in assigned.items():
            if not others and name not in alloca and all(label in before[one] and label < one for one in used[name]):
                self._singly_assigned_vars.add(name)

    def setup_function(self, fndesc: Any) -> None:
        if not isinstance(self.library, KERNELS):
            super().setup_function(fndesc)
            return
        self.function = declared(self.module, fndesc)
        self.entry_block = self.function.append_basic_block("entry")
        self.builder = ir.IRBuilder(self.entry_block)
        self.call_helper = self.call_conv.init_call_helper(self.builder)

    def alloca_lltype(self, name: str, lltype: Any, datamodel: Any = None) -> Any:
        if self._disable_sroa_like_opt:
            return super().alloca_lltype(name, lltype, datamodel)
        with self.builder.goto_entry_block():
            return self.builder.alloca(lltype)

    def delvar(self, name: str) -> None:
        if self._disable_sroa_like_opt:
            super().delvar(name)
        elif name not in self._blk_local_varmap:
            self._singly_assigned_vars.discard(name)

    def storevar(self, value: Any, name: str, argidx: int | None = None) -> None:
        if self._disable_sroa_like_opt:
            super().storevar(value, name, argidx)
        elif name in self._singly_assigned_vars:
            self._blk_local_varmap[name] = value
        else:
            self._alloca_var(name, self.typeof(name))
            self.builder.store(value, self.getvar(name))


@register_pass(mutates_CFG=True, analysis_only=False)
class _Lowering(NativeLowering):
    _name = "kernel_lowering"
    lowering_class = _Lower


def compiler(kind: str, name: str | None) -> type[Compiler]:
    """Return a compiler without needless passes, for one function of such a kind, see `LIBRARIES`.

    With a `name` the symbol of the function is the same in every process. Numba counts instead, and what one process
    calls by a number another one calls by another.
    """

    class KernelCompiler(Compiler):
        def define_pipelines(self) -> list[PassManager]:
            state = self.state
            if name is not None:
                state.func_id.unique_id = name
            state.library = LIBRARIES[kind](state.targetctx.codegen(), state.func_id.func_qualname)
            state.library.enable_object_caching()
            (pipeline,) = super().define_pipelines()
            manager = PassManager(pipeline.pipeline_name)
            manager.passes = [
                (_Lowering if each is NativeLowering else each, what)
                for each, what in pipeline.passes
                if each.__name__ not in NEEDLESS
            ]
            manager.finalize()
            return [manager]

    return KernelCompiler


def _seen(module: Any) -> str:
    """Numba's environments in a module, as text."""
    names = [one.name for one in module.global_variables if one.name.startswith(ENVIRONMENT)]
    return "".join(f"@{name} = common global i8* null\n" for name in names)
