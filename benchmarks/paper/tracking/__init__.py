"""`python -m benchmarks tracking`: a path of 180 points behind random spheres."""
