(define (domain irc_task)
  (:requirements :durative-actions :fluents)
  (:predicates
    (todo_drive)
    (done_drive)
    (todo_drive_back)
    (done_drive_back)
    (todo_fill_up)
    (done_fill_up))
  (:functions
    (level_of_fuel)
    (level_of_trips))
  (:durative-action drive
    :parameters ()
    :duration (= ?duration 5)
    :condition (and (at start (todo_drive)) (at start (>= (level_of_fuel) 8)) (over all (<= (level_of_trips) 1)))
    :effect (and (at start (not (todo_drive))) (at end (done_drive)) (at start (decrease (level_of_fuel) 8)) (at end (increase (level_of_trips) 1))))
  (:durative-action drive_back
    :parameters ()
    :duration (= ?duration 5)
    :condition (and (at start (todo_drive_back)) (at start (= (level_of_trips) 1)) (at start (>= (level_of_fuel) 8)))
    :effect (and (at start (not (todo_drive_back))) (at end (done_drive_back)) (at start (decrease (level_of_fuel) 8))))
  (:durative-action fill_up
    :parameters ()
    :duration (= ?duration 2)
    :condition (and (at start (todo_fill_up)))
    :effect (and (at start (not (todo_fill_up))) (at end (done_fill_up)) (at end (assign (level_of_fuel) 18)))))
