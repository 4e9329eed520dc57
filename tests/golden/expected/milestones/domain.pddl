(define (domain irc_task)
  (:requirements :durative-actions)
  (:predicates
    (todo_dig)
    (done_dig)
    (todo_build)
    (done_build)
    (todo_ready)
    (done_ready))
  (:durative-action dig
    :parameters ()
    :duration (= ?duration 3)
    :condition (and (at start (todo_dig)))
    :effect (and (at start (not (todo_dig))) (at end (done_dig))))
  (:durative-action build
    :parameters ()
    :duration (= ?duration 5)
    :condition (and (at start (todo_build)) (at start (done_ready)))
    :effect (and (at start (not (todo_build))) (at end (done_build))))
  (:action ready
    :parameters ()
    :precondition (and (todo_ready) (done_dig))
    :effect (and (not (todo_ready)) (done_ready))))
