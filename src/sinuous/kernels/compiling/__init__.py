"""How kernels become machine code: what is compiled (`pieces`), how (`once`), and where it is kept (`store`)."""
