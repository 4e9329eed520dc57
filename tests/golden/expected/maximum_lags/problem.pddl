(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (todo_wait_1_after_roll)
    (todo_keep_roll_start_by_heat)
    (todo_keep_cool_by_roll)
    (todo_heat)
    (todo_cool)
    (todo_roll))
  (:goal (and
    (done_heat)
    (done_cool)
    (done_roll)))
  (:metric minimize (total-time)))
