; Satellites turn to targets, warm up instruments, calibrate them on a known target, and take
; images. Power is for one instrument at a time; switching off gives it back.
(define (domain satellite)
  (:requirements :typing :strips :fluents :equality :durative-actions :duration-inequalities)
  (:types satellite instrument mode direction)
  (:predicates
    (on-board ?i - instrument ?s - satellite)
    (supports ?i - instrument ?m - mode)
    (pointing ?s - satellite ?d - direction)
    (power-avail ?s - satellite)
    (power-on ?i - instrument)
    (calibrated ?i - instrument)
    (calibration-target ?i - instrument ?d - direction)
    (have-image ?d - direction ?m - mode))
  (:functions (slew-time ?a ?b - direction) (calibration-time ?i - instrument))
  (:durative-action turn-to
    :parameters (?s - satellite ?new ?old - direction)
    :duration (= ?duration (slew-time ?old ?new))
    :condition (and (at start (pointing ?s ?old)) (over all (not (= ?new ?old))))
    :effect (and (at end (pointing ?s ?new)) (at start (not (pointing ?s ?old)))))
  (:durative-action switch-on
    :parameters (?i - instrument ?s - satellite)
    :duration (and (>= ?duration 2) (<= ?duration 6))
    :condition (and (over all (on-board ?i ?s)) (at start (power-avail ?s)))
    :effect (and (at end (power-on ?i)) (at start (not (calibrated ?i)))
                 (at start (not (power-avail ?s)))))
  (:durative-action switch-off
    :parameters (?i - instrument ?s - satellite)
    :duration (= ?duration 1)
    :condition (and (over all (on-board ?i ?s)) (at start (power-on ?i)))
    :effect (and (at start (not (power-on ?i))) (at end (power-avail ?s))))
  (:durative-action calibrate
    :parameters (?s - satellite ?i - instrument ?d - direction)
    :duration (= ?duration (calibration-time ?i))
    :condition (and (over all (on-board ?i ?s)) (over all (calibration-target ?i ?d))
                    (at start (pointing ?s ?d)) (over all (power-on ?i)) (at end (power-on ?i)))
    :effect (at end (calibrated ?i)))
  (:durative-action take-image
    :parameters (?s - satellite ?d - direction ?i - instrument ?m - mode)
    :duration (= ?duration 7)
    :condition (and (over all (calibrated ?i)) (over all (on-board ?i ?s))
                    (over all (supports ?i ?m)) (over all (power-on ?i))
                    (over all (pointing ?s ?d)) (at end (power-on ?i)))
    :effect (at end (have-image ?d ?m))))
