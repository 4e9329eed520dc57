(define (problem dark) (:domain lamp) (:init) (:goal (on bulb))
  (:metric minimize (+ (total-time) (total-cost))))
