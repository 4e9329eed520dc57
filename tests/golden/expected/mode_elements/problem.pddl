(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (is_power_true)
    (todo_heat_pie)
    (todo_light_lamp)
    (= (sum_of_cost) 0)
    (= (level_of_wood) 3))
  (:goal (and
    (done_heat_pie)
    (done_light_lamp)))
  (:metric minimize (sum_of_cost)))
