(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (todo_dig)
    (todo_frame)
    (todo_pour)
    (= (left_of_crew) 20))
  (:goal (and
    (done_dig)
    (done_frame)
    (done_pour)))
  (:metric minimize (total-time)))
