"""From a problem to the files of a CP-SAT model.

`encode` orchestrates: it hands one `builder`, which imports no other module of this package, from
element to element. There is one module for each kind of element.
"""
