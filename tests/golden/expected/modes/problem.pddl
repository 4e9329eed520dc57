(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (free_hand_1)
    (free_press_1)
    (todo_squash)
    (todo_peel)
    (todo_juice))
  (:goal (and
    (done_squash)
    (done_peel)
    (done_juice)))
  (:metric minimize (total-time)))
