(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (todo_dig)
    (todo_build)
    (todo_ready))
  (:goal (and
    (done_dig)
    (done_build)
    (done_ready)))
  (:metric minimize (total-time)))
