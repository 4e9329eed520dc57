"""From a problem to a PDDL2.1 domain and problem.

`encode` orchestrates: it hands one `builder` from element to element. There is one module for each
kind of element; `pddl` prints.
"""
