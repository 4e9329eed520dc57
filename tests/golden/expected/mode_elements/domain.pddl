(define (domain irc_task)
  (:requirements :durative-actions :fluents)
  (:predicates
    (is_power_true)
    (todo_heat_pie)
    (done_heat_pie)
    (todo_light_lamp)
    (done_light_lamp))
  (:functions
    (sum_of_cost)
    (level_of_wood))
  (:durative-action heat_pie__quick
    :parameters ()
    :duration (= ?duration 6)
    :condition (and (at start (todo_heat_pie)) (over all (is_power_true)))
    :effect (and (at start (not (todo_heat_pie))) (at end (not (is_power_true))) (at end (done_heat_pie)) (at end (increase (sum_of_cost) 10))))
  (:durative-action heat_pie__slow
    :parameters ()
    :duration (= ?duration 25)
    :condition (and (at start (todo_heat_pie)) (at start (>= (level_of_wood) 2)))
    :effect (and (at start (not (todo_heat_pie))) (at end (done_heat_pie)) (at start (decrease (level_of_wood) 2)) (at end (increase (sum_of_cost) 5))))
  (:durative-action light_lamp
    :parameters ()
    :duration (= ?duration 5)
    :condition (and (at start (todo_light_lamp)) (at start (is_power_true)) (at start (>= (level_of_wood) 2)))
    :effect (and (at start (not (todo_light_lamp))) (at end (done_light_lamp)) (at start (decrease (level_of_wood) 2)))))
