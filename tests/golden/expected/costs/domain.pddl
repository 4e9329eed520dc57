(define (domain irc_task)
  (:requirements :durative-actions :fluents)
  (:predicates
    (is_moved_true)
    (todo_walk)
    (todo_taxi))
  (:functions
    (sum_of_cost))
  (:durative-action walk
    :parameters ()
    :duration (= ?duration 5)
    :condition (and (at start (todo_walk)))
    :effect (and (at start (not (todo_walk))) (at end (is_moved_true)) (at end (increase (sum_of_cost) 1))))
  (:durative-action taxi
    :parameters ()
    :duration (= ?duration 1)
    :condition (and (at start (todo_taxi)))
    :effect (and (at start (not (todo_taxi))) (at end (is_moved_true)) (at end (increase (sum_of_cost) 9)))))
