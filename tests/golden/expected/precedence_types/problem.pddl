(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (todo_wait_1_after_a)
    (todo_a)
    (todo_d)
    (todo_b)
    (todo_c))
  (:goal (and
    (done_a)
    (done_d)
    (done_b)
    (done_c)))
  (:metric minimize (total-time)))
