; Three fuses and two matches: two fuses fit into one match, so the third waits for the second.
(define (problem three-fuses)
  (:domain matchcellar)
  (:objects match1 match2 - match fuse1 fuse2 fuse3 - fuse)
  (:init (hand-free) (unused match1) (unused match2))
  (:goal (and (mended fuse1) (mended fuse2) (mended fuse3)))
  (:metric minimize (total-time)))
