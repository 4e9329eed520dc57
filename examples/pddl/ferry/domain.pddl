; A ferry carries cars over a river, but only while the harbour is open, which the clock decides.
(define (domain ferry)
  (:requirements :strips :typing :durative-actions :timed-initial-literals)
  (:types bank car)
  (:predicates
    (ferry-at ?b - bank)
    (at ?c - car ?b - bank)
    (open)
    (other ?a ?b - bank))
  (:durative-action cross
    :parameters (?a ?b - bank)
    :duration (= ?duration 3)
    :condition (and (at start (ferry-at ?a)) (over all (open)) (over all (other ?a ?b)))
    :effect (and (at start (not (ferry-at ?a))) (at end (ferry-at ?b))))
  (:durative-action carry
    :parameters (?c - car ?a ?b - bank)
    :duration (= ?duration 4)
    :condition (and (at start (ferry-at ?a)) (at start (at ?c ?a)) (over all (open))
                    (over all (other ?a ?b)))
    :effect (and (at start (not (ferry-at ?a))) (at start (not (at ?c ?a)))
                 (at end (ferry-at ?b)) (at end (at ?c ?b)))))
