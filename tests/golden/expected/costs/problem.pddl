(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (todo_walk)
    (todo_taxi)
    (= (sum_of_cost) 0))
  (:goal (and
    (is_moved_true)))
  (:metric minimize (sum_of_cost)))
