; The harbour opens at 10 and closes at 25; the ferry starts on the wrong side.
(define (problem two-cars)
  (:domain ferry)
  (:objects north south - bank red blue - car)
  (:init
    (ferry-at south) (at red north) (at blue north) (other north south) (other south north)
    (at 10 (open)) (at 25 (not (open))))
  (:goal (and (at red south) (at blue south)))
  (:metric minimize (total-time)))
