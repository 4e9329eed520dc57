(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (todo_drive)
    (todo_drive_back)
    (todo_fill_up)
    (= (level_of_fuel) 9)
    (= (level_of_trips) 0))
  (:goal (and
    (done_drive)
    (done_drive_back)
    (done_fill_up)
    (>= (level_of_fuel) 10)))
  (:metric minimize (total-time)))
