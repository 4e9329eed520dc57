(define (domain irc_task)
  (:requirements :durative-actions :fluents)
  (:predicates
    (todo_dig)
    (done_dig)
    (todo_frame)
    (done_frame)
    (todo_pour)
    (done_pour))
  (:functions
    (left_of_crew))
  (:durative-action dig
    :parameters ()
    :duration (= ?duration 4)
    :condition (and (at start (todo_dig)) (at start (>= (left_of_crew) 12)))
    :effect (and (at start (not (todo_dig))) (at start (decrease (left_of_crew) 12)) (at end (done_dig)) (at end (increase (left_of_crew) 12))))
  (:durative-action frame
    :parameters ()
    :duration (= ?duration 6)
    :condition (and (at start (todo_frame)) (at start (>= (left_of_crew) 8)))
    :effect (and (at start (not (todo_frame))) (at start (decrease (left_of_crew) 8)) (at end (done_frame)) (at end (increase (left_of_crew) 8))))
  (:durative-action pour
    :parameters ()
    :duration (= ?duration 3)
    :condition (and (at start (todo_pour)) (at start (done_dig)) (at start (>= (left_of_crew) 10)))
    :effect (and (at start (not (todo_pour))) (at start (decrease (left_of_crew) 10)) (at end (done_pour)) (at end (increase (left_of_crew) 10)))))
