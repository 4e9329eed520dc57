(define (domain irc_task)
  (:requirements :durative-actions :fluents)
  (:predicates
    (todo_bake)
    (done_bake)
    (todo_sample)
    (done_sample)
    (todo_deliver)
    (done_deliver))
  (:functions
    (level_of_flour))
  (:durative-action bake
    :parameters ()
    :duration (= ?duration 3)
    :condition (and (at start (todo_bake)) (at start (>= (level_of_flour) 3)))
    :effect (and (at start (not (todo_bake))) (at end (done_bake)) (at start (decrease (level_of_flour) 2))))
  (:durative-action sample
    :parameters ()
    :duration (= ?duration 2)
    :condition (and (at start (todo_sample)) (at end (>= (level_of_flour) 2)))
    :effect (and (at start (not (todo_sample))) (at end (done_sample)) (at end (decrease (level_of_flour) 1))))
  (:durative-action deliver
    :parameters ()
    :duration (= ?duration 1)
    :condition (and (at start (todo_deliver)) (at end (<= (level_of_flour) 2)))
    :effect (and (at start (not (todo_deliver))) (at end (done_deliver)) (at end (increase (level_of_flour) 2)))))
