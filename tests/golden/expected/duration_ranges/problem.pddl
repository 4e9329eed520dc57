(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (todo_keep_chop_by_simmer)
    (todo_keep_simmer_by_chop)
    (free_pan_1)
    (todo_chop)
    (todo_simmer)
    (todo_rest))
  (:goal (and
    (done_chop)
    (done_simmer)
    (done_rest)))
  (:metric minimize (total-time)))
