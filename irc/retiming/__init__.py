"""Re-timing where there is more to keep than the order on resources.

`selection`: what was chosen, as a problem of only that. `state`, `stock`, `calendar`: what each of
them demands of the order and of the times. `ranks`: the order within an instant. `rich`: all of it
together. Only tasks that need it load this package; see `irc.retiming.retime`.
"""
