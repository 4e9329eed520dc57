(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (todo_step1)
    (todo_step2)
    (todo_step3))
  (:goal (and
    (done_step1)
    (done_step2)
    (done_step3)))
  (:metric minimize (total-time)))
