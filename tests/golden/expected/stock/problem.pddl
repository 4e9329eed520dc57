(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (todo_bake)
    (todo_sample)
    (todo_deliver)
    (= (level_of_flour) 2))
  (:goal (and
    (done_bake)
    (done_sample)
    (done_deliver)))
  (:metric minimize (total-time)))
