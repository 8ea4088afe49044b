"""Settings that all tests share."""

import os

from hypothesis import HealthCheck, settings

from tests import callable_kernels

# Matrices are tiny here: threads of a linear algebra library only wait for each other, on a busy machine a thousand
# times as long as the work takes. Read when NumPy is first imported, which is later.
for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

# Before any kernel is made: tests call every one of them from Python.
callable_kernels.install()

# The first example of a law may compile a kernel, so that time says nothing; the same examples every time.
settings.register_profile(
    "sinuous",
    max_examples=50,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("sinuous")
