(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (free_board_1)
    (free_board_2)
    (free_board_3)
    (todo_dice)
    (todo_slice)
    (todo_cut))
  (:goal (and
    (done_dice)
    (done_slice)
    (done_cut)))
  (:metric minimize (total-time)))
