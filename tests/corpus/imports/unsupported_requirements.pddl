(define (domain lamp)
  (:requirements :strips :conditional-effects :derived-predicates)
  (:predicates (on) (broken))
  (:action press :parameters () :precondition (not (on)) :effect (when (not (broken)) (on))))
