(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (free_lab_1)
    (todo_mix)
    (todo_age)
    (todo_test)
    (at 6 (released_6)))
  (:goal (and
    (done_mix)
    (done_age)
    (done_test)))
  (:metric minimize (total-time)))
