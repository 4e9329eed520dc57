(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (todo_meet_chop_and_simmer)
    (free_pan_1)
    (todo_chop)
    (todo_simmer)
    (todo_rest))
  (:goal (and
    (done_chop)
    (done_simmer)
    (done_rest)))
  (:metric minimize (total-time)))
