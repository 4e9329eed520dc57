; Parcels are carried by vans, vans are driven by drivers, and drivers walk between places. How
; long a way takes is given for each two places.
(define (domain deliveries)
  (:requirements :strips :typing :equality :negative-preconditions :fluents :durative-actions)
  (:types place - object driver van parcel - thing)
  (:constants depot - place)
  (:predicates
    (at ?x - thing ?p - place)
    (in ?c - parcel ?v - van)
    (driving ?d - driver ?v - van)
    (taken ?v - van)
    (road ?from ?to - place)
    (path ?from ?to - place))
  (:functions
    (drive-time ?from ?to - place)
    (walk-time ?from ?to - place)
    (weight ?c - parcel))
  (:durative-action load
    :parameters (?c - parcel ?v - van ?p - place)
    :duration (= ?duration (+ 1 (* 0.5 (weight ?c))))
    :condition (and (over all (at ?v ?p)) (at start (at ?c ?p)))
    :effect (and (at start (not (at ?c ?p))) (at end (in ?c ?v))))
  (:durative-action unload
    :parameters (?c - parcel ?v - van ?p - place)
    :duration (= ?duration 1)
    :condition (and (over all (at ?v ?p)) (at start (in ?c ?v)))
    :effect (and (at start (not (in ?c ?v))) (at end (at ?c ?p))))
  (:action board
    :parameters (?d - driver ?v - van ?p - place)
    :precondition (and (at ?d ?p) (at ?v ?p) (not (taken ?v)))
    :effect (and (not (at ?d ?p)) (driving ?d ?v) (taken ?v)))
  (:action leave
    :parameters (?d - driver ?v - van ?p - place)
    :precondition (and (at ?v ?p) (driving ?d ?v))
    :effect (and (not (driving ?d ?v)) (at ?d ?p) (not (taken ?v))))
  (:durative-action drive
    :parameters (?d - driver ?v - van ?from ?to - place)
    :duration (= ?duration (drive-time ?from ?to))
    :condition (and (at start (at ?v ?from)) (over all (driving ?d ?v)) (at start (road ?from ?to)))
    :effect (and (at start (not (at ?v ?from))) (at end (at ?v ?to))))
  (:durative-action walk
    :parameters (?d - driver ?from ?to - place)
    :duration (= ?duration (walk-time ?from ?to))
    :condition (and (at start (at ?d ?from)) (at start (path ?from ?to)) (at start (not (= ?from ?to))))
    :effect (and (at start (not (at ?d ?from))) (at end (at ?d ?to)))))
