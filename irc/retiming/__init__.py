"""Re-timing: in, an engine's decisions; out, the exact earliest schedule.

`selection`: the problem of only the chosen activities and modes. `resources`, `state`, `stock`,
`calendar`: the orders and times that each of them demands. `ranks`: the order within an instant.
`rich`: all of it together, which only tasks that need it load. See `irc.retiming.retime`.
"""
