(define (problem two-images)
  (:domain satellite)
  (:objects
    orbiter - satellite camera - instrument thermal - mode
    star1 phenomenon2 phenomenon3 - direction)
  (:init
    (on-board camera orbiter) (supports camera thermal) (calibration-target camera star1)
    (power-avail orbiter) (pointing orbiter phenomenon2)
    (= (calibration-time camera) 3)
    (= (slew-time star1 phenomenon2) 5) (= (slew-time phenomenon2 star1) 5)
    (= (slew-time star1 phenomenon3) 8) (= (slew-time phenomenon3 star1) 8)
    (= (slew-time phenomenon2 phenomenon3) 2.5) (= (slew-time phenomenon3 phenomenon2) 2.5))
  (:goal (and (have-image phenomenon2 thermal) (have-image phenomenon3 thermal)))
  (:metric minimize (total-time)))
