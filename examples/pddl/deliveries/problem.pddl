; The driver walks to the van, fetches a parcel from the market, and walks home.
(define (problem one-van)
  (:domain deliveries)
  (:objects home market - place ann - driver van1 - van crate - parcel)
  (:init
    (at ann home) (at van1 depot) (at crate market)
    (path home depot) (path depot home) (road depot market) (road market depot)
    (= (walk-time home depot) 4) (= (walk-time depot home) 4)
    (= (drive-time depot market) 3.5) (= (drive-time market depot) 3.5)
    (= (weight crate) 3))
  (:goal (and (at crate depot) (at ann home) (not (taken van1)))))
