"""How kernels call each other: an array is its address and shape, what is returned comes back, and nothing is raised.

Numba hands over seven fields of every array and more of larger ones, has each result written to memory, and asks after
each call whether something was raised: half of what LLVM was given. Kernels own no array and raise nothing. So what is
not needed is left out between them; what Numba brings itself is called as ever, and so are entries by Python.
"""

import copy
from functools import cache
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.callconv import CPUCallConv
from numba.core.cpu import CPUContext
from numba.core.datamodel import models, registry
from numba.core.datamodel.packer import ArgPacker
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
