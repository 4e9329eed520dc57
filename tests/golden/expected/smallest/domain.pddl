(define (domain irc_task)
  (:requirements :durative-actions)
  (:predicates
    (todo_step1)
    (done_step1)
    (todo_step2)
    (done_step2)
    (todo_step3)
    (done_step3))
  (:durative-action step1
    :parameters ()
    :duration (= ?duration 4)
    :condition (and (at start (todo_step1)))
    :effect (and (at start (not (todo_step1))) (at end (done_step1))))
  (:durative-action step2
    :parameters ()
    :duration (= ?duration 2)
    :condition (and (at start (todo_step2)) (at start (done_step1)))
    :effect (and (at start (not (todo_step2))) (at end (done_step2))))
  (:durative-action step3
    :parameters ()
    :duration (= ?duration 3)
    :condition (and (at start (todo_step3)) (at start (done_step2)))
    :effect (and (at start (not (todo_step3))) (at end (done_step3)))))
