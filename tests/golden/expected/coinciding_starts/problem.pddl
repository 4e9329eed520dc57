(define (problem irc_task_1)
  (:domain irc_task)
  (:init
    (todo_meet_act_start_and_record_start)
    (todo_meet_film_start_and_record_start)
    (todo_act)
    (todo_film)
    (todo_record)
    (at 10 (released_1)))
  (:goal (and
    (done_act)
    (done_film)
    (done_record)))
  (:metric minimize (total-time)))
