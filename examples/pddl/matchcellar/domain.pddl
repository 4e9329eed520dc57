; Fuses are mended in a dark cellar by the light of matches. A match burns for a while and goes
; out; whoever mends needs a free hand and light all the while. So mending must happen inside the
; burning of a match: no sequence of the actions is a plan.
(define (domain matchcellar)
  (:requirements :strips :typing :negative-preconditions :durative-actions)
  (:types match fuse)
  (:predicates
    (light)
    (hand-free)
    (unused ?m - match)
    (mended ?f - fuse))
  (:durative-action light-match
    :parameters (?m - match)
    :duration (= ?duration 5)
    :condition (and (at start (unused ?m)) (at start (not (light))) (over all (light)))
    :effect (and (at start (not (unused ?m))) (at start (light)) (at end (not (light)))))
  (:durative-action mend-fuse
    :parameters (?f - fuse)
    :duration (= ?duration 2)
    :condition (and (at start (hand-free)) (over all (light)))
    :effect (and (at start (not (hand-free))) (at end (mended ?f)) (at end (hand-free)))))
