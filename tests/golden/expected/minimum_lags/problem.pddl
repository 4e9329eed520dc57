(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (todo_wait_3_after_bake)
    (todo_keep_ice_by_serve_start)
    (todo_bake)
    (todo_ice)
    (todo_serve))
  (:goal (and
    (done_bake)
    (done_ice)
    (done_serve)))
  (:metric minimize (total-time)))
