"""Compiles loops over whole numbers and tables of them to machine code, by LLVM.

Numbers have 64 bits. A function consists of assignments, `if`, `while`, `for … in range(…)`,
arithmetic, comparisons, `min`, `max`, `len`, `shape`, rows of tables, and calls of other functions
of its module; all else is refused with its place. A module becomes one piece of machine code, since
to compile a function once takes less than to compile it into each of its callers.
"""
