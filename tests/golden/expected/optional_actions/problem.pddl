(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (todo_wait_2_after_dry)
    (todo_dry)
    (todo_wash)
    (todo_label)
    (todo_pack))
  (:goal (and
    (done_dry)
    (done_wash)
    (done_label)
    (done_pack)))
  (:metric minimize (total-time)))
