"""A text of the DSL that says a little of everything, for tests of editor support."""

KITCHEN = """\
# a kitchen
task "rested combo"
unit min
days per month 30
resolution 1 s
calendar day shift zone "Europe/Berlin" open mon .. fri 06:00 .. 14:00 closed 2026-12-25
calendar cycle every 1 day open 6 .. 14
resource grill, board capacity 2 label "the board"
resource press no idle setup initial clean setup from red -> blue = 20 min cost 5
resource saw setup from * -> red = 30
resource bench during calendar day shift
resource oven takes loads capacity 10
stock flour initial 3 within 0 .. 10
pool robots = r1, r2
state chicken = raw, grilled initial raw
state open initial true changes to false at 2 h changes to true at 3 h
state heat = number initial 2.5 within 0 .. 9 changes to 1/3 at 1 h
include "more.irc"
for item in lettuce, cucumber:
    cut {item} 3s on board by robots
grill chicken 1 h 30 min .. 2h  on grill * 1 needs chicken = raw at start sets chicken = grilled
rest 0.5h occurs 0 .. 2 after grill chicken + 3 .. 20, end of cut lettuce starts at 2026-01-01T08:00
print 9 min on press of family red
stir 3 needs heat >= 1 <= 8, heat == 2 at end sets heat += 1, heat -= 2 at start, heat := 3
taste 1 min starts by 35 ends from 3 when broken restart
polish 5 min during calendar cycle may pause at most 2 h
grill chicken -> start of rest
same resource print use 0, polish
different mode stir, taste
if print mode fast or slow then polish on press use 1
select 1 .. 2 of stir, taste if polish
select all or none of stir, taste
consecutive print, polish on press
same order on press, saw jobs [print, polish], [stir, taste]
goal chicken = grilled, heat <= 4
deadline 40
minimize makespan, cost
event late at PT5M:
    add wash 3 min
    add: resource r3
    set capacity of grill = 0 during 1 .. 2
    set deadline of action rest = none
    observe rest started 5
"""
