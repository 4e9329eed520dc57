(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (free_robot1_robot2_1)
    (free_robot1_robot2_2)
    (todo_carry)
    (todo_place)
    (todo_fetch))
  (:goal (and
    (done_carry)
    (done_place)
    (done_fetch)))
  (:metric minimize (total-time)))
