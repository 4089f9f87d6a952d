(** The policy of a dynamic scenario, in its seven steps: `semantics/dynamics/policy.py`. The paper's Section "Semantics of Scenic", "Dynamic
    Constructs", whose sentences are quoted.

    What the coroutines of a time step do is given: this is about what the policy makes of it. There is one scenario that runs, the top-level
    one; a `require eventually` counts from the first time step on (reading `eventually-window`), and all behaviors run in a time step, even
    where one of them has terminated the scenario (reading `behaviors-after-terminate`).

    - [the_verdict_is_that_of_the_first_step_that_decides]: the seven steps in their order, exactly;
      [a_simulation_is_discarded_in_the_first_step_that_fails_if_none_before_ends_it],
      [a_simulation_terminates_in_step_4_whatever_the_behaviors_do],
      [a_simulation_terminates_in_step_6_exactly_if_a_behavior_ends_it_where_nothing_failed_or_ended_it_before],
      [actions_are_returned_exactly_if_nothing_fails_and_nothing_ends_the_simulation] spell it out, verdict by verdict;
    - what follows for whole simulations: [a_terminated_simulation_has_satisfied_every_require_always_at_every_time_step],
      [a_simulation_that_terminates_has_satisfied_every_require_eventually_since_it_began],
      [a_simulation_that_is_thrown_away_failed_a_requirement]. *)
From Coq Require Import List Bool Arith Lia.
Import ListNotations.

(** What a compose block, a monitor or a behavior does in a time step: a `require` that does not hold is a failure. *)
Inductive turn : Type := Goes_on | Terminates | Fails.

Record time_step (action : Type) : Type := {
  compose : turn;             (* the compose block of the top-level scenario *)
  is_over : bool;             (* it finishes its compose block, or one of its `terminate when` conditions is true *)
  always : list bool;         (* the `require always` conditions, as they are now *)
  eventually : list bool;     (* the `require eventually` conditions, as they are now *)
  monitors : list turn;
  behaviors : list (turn * action)
}.
Arguments compose {action}. Arguments is_over {action}. Arguments always {action}. Arguments eventually {action}.
Arguments monitors {action}. Arguments behaviors {action}.

Inductive verdict (action : Type) : Type :=
| Discarded (step : nat)
| Terminated (step : nat)
| Acts (actions : list action).
Arguments Discarded {action}. Arguments Terminated {action}. Arguments Acts {action}.

(** Whether one of them terminates the scenario, or nothing if one of them fails. *)
Fixpoint run_all (turns : list turn) : option bool :=
  match turns with
  | [] => Some false
  | Goes_on :: rest => run_all rest
  | Terminates :: rest => option_map (fun _ => true) (run_all rest)
  | Fails :: _ => None
  end.

(** Which `require eventually` conditions were satisfied at some time step, with the present one. *)
Fixpoint seen (before now : list bool) : list bool :=
  match before, now with
  | b :: before', n :: now' => (b || n) :: seen before' now'
  | _, _ => []
  end.

Definition all (conditions : list bool) : bool := forallb (fun holds => holds) conditions.

Section Policy.
Context {action : Type}.

(** "If the flag is set, check that all require eventually conditions were satisfied at some time step: if so, terminate the simulation;
    otherwise, discard it." *)
Definition check_flag (step : nat) (flag : bool) (satisfied : list bool) (next : verdict action) : verdict action :=
  if flag then (if all satisfied then Terminated step else Discarded step) else next.

(** The seven steps: `before` says which `require eventually` conditions were satisfied in an earlier time step. *)
Definition policy (before : list bool) (now : time_step action) : verdict action :=
  match run_all [compose now] with                                               (* 1 *)
  | None => Discarded 1
  | Some composed =>
      if all (always now) then                                                   (* 2 *)
        match run_all (monitors now) with                                        (* 3 *)
        | None => Discarded 3
        | Some monitored =>
            let satisfied := seen before (eventually now) in
            check_flag 4 (composed || is_over now || monitored) satisfied        (* 4 *)
              match run_all (map fst (behaviors now)) with                       (* 5 *)
              | None => Discarded 5
              | Some behaved =>
                  check_flag 6 behaved satisfied                                 (* 6 *)
                    (Acts (map snd (behaviors now)))                             (* 7 *)
              end
        end
      else Discarded 2
  end.

Inductive ending : Type := Thrown_away (time step : nat) | Over (time step : nat) | Still_running.

(** A simulation: the actions of each time step, and how it ends. *)
Fixpoint simulation (time : nat) (before : list bool) (history : list (time_step action)) : list (list action) * ending :=
  match history with
  | [] => ([], Still_running)
  | now :: rest =>
      match policy before now with
      | Discarded step => ([], Thrown_away time step)
      | Terminated step => ([], Over time step)
      | Acts actions => let (later, ending) := simulation (S time) (seen before (eventually now)) rest in (actions :: later, ending)
      end
  end.

(** * What a verdict says *)

Definition nothing_failed (now : time_step action) : Prop :=
  compose now <> Fails /\ Forall (fun holds => holds = true) (always now) /\ ~ In Fails (monitors now) /\ ~ In Fails (map fst (behaviors now)).

Lemma run_all_some turns flag : run_all turns = Some flag -> ~ In Fails turns /\ (flag = true <-> In Terminates turns).
Proof.
  revert flag; induction turns as [|t rest IH]; simpl; intros flag H; [injection H as <-; split; [easy|split; easy]|].
  destruct t; [|destruct (run_all rest) as [f|]; [|discriminate]|discriminate]; simpl in H.
  - destruct (IH _ H) as [A B]; split; [intros [E|E]; [discriminate|tauto]|]. rewrite B; split; [tauto|intros [E|E]; [discriminate|tauto]].
  - injection H as <-. destruct (IH f eq_refl) as [A _]; split; [intros [E|E]; [discriminate|tauto]|tauto].
Qed.

Lemma run_all_none turns : run_all turns = None <-> In Fails turns.
Proof.
  induction turns as [|t rest IH]; simpl; [now split|]. destruct t; simpl.
  - rewrite IH; split; [tauto|intros [E|E]; [discriminate|exact E]].
  - destruct (run_all rest); simpl; split; try discriminate.
    + intros [E|E]; [discriminate|]. apply IH in E; discriminate.
    + intros _; right; now apply IH.
    + reflexivity.
  - split; [now left|reflexivity].
Qed.

Lemma all_forall conditions : all conditions = true <-> Forall (fun holds => holds = true) conditions.
Proof. unfold all; rewrite forallb_forall, Forall_forall; reflexivity. Qed.

Ltac steps H :=
  unfold policy, check_flag in H; simpl run_all at 1 in H;
  repeat match type of H with
  | context [match compose ?n with _ => _ end] => destruct (compose n) eqn:?
  | context [if all ?l then _ else _] => destruct (all l) eqn:?
  | context [match run_all ?l with _ => _ end] => destruct (run_all l) eqn:?
  | context [if ?f then _ else _] => destruct f eqn:?
  end; simpl in H; try discriminate.

Theorem no_action_is_returned_in_a_time_step_in_which_a_requirement_failed before now actions :
  policy before now = Acts actions -> nothing_failed now /\ actions = map snd (behaviors now).
Proof.
  intro H; steps H; injection H as <-; split; try reflexivity; unfold nothing_failed;
  repeat match goal with E : run_all _ = Some _ |- _ => apply run_all_some in E as [? _] end;
  rewrite <- all_forall; repeat split; congruence || tauto.
Qed.

Theorem no_action_is_returned_in_a_time_step_in_which_the_scenario_ends before now actions :
  policy before now = Acts actions ->
  compose now <> Terminates /\ is_over now = false /\ ~ In Terminates (monitors now) /\ ~ In Terminates (map fst (behaviors now)).
Proof.
  intro H; unfold policy, check_flag in H.
  destruct (run_all [compose now]) as [c|] eqn:C; [|discriminate].
  destruct (all (always now)); [|discriminate].
  destruct (run_all (monitors now)) as [m|] eqn:M; [|discriminate].
  destruct (c || is_over now || m) eqn:F; [destruct (all _); discriminate|].
  destruct (run_all (map fst (behaviors now))) as [b|] eqn:B; [|discriminate].
  destruct b; [destruct (all _); discriminate|].
  apply orb_false_elim in F as [F ->]; apply orb_false_elim in F as [-> O].
  apply run_all_some in C as [_ [_ C]], M as [_ [_ M]], B as [_ [_ B]].
  repeat split; [intro E; rewrite E in C; discriminate (C (or_introl eq_refl))|exact O|intro E; discriminate (M E)|intro E; discriminate (B E)].
Qed.

Theorem a_requirement_that_fails_in_the_first_three_steps_discards_the_simulation_though_the_flag_is_set before now :
  compose now = Fails \/ all (always now) = false \/ In Fails (monitors now) ->
  exists step, policy before now = Discarded step /\ 1 <= step <= 3.
Proof.
  intro H; unfold policy; destruct (compose now) eqn:C; simpl; try (exists 1; split; [reflexivity|lia]);
  (destruct (all (always now)) eqn:A; [|exists 2; split; [reflexivity|lia]]);
  (destruct (run_all (monitors now)) eqn:M; [|exists 3; split; [reflexivity|lia]]);
  apply run_all_some in M as [M _]; exfalso; intuition (discriminate || congruence).
Qed.

Theorem a_behavior_that_fails_discards_the_simulation_though_another_terminates_the_scenario before now :
  compose now = Goes_on -> is_over now = false -> all (always now) = true -> run_all (monitors now) = Some false ->
  In Fails (map fst (behaviors now)) -> policy before now = Discarded 5.
Proof. intros C O A M B. apply run_all_none in B. unfold policy, check_flag. now rewrite C, A, M, O, B. Qed.

(** * The order of the steps *)

(** The flag as it is at step 4, where no behavior has run yet. *)
Definition flag_is_set (now : time_step action) : Prop :=
  compose now = Terminates \/ is_over now = true \/ In Terminates (monitors now).

(** Every `require eventually` condition was satisfied at some time step, the present one included. *)
Definition all_satisfied (before : list bool) (now : time_step action) : Prop :=
  Forall (fun holds => holds = true) (seen before (eventually now)).

(** Whether step `k` ends the simulation, if all `require eventually` conditions were satisfied, and what it discards the simulation for: steps
    4 and 6 for such a condition that was not, the others for a requirement that fails. *)
Definition ends (now : time_step action) (k : nat) : Prop :=
  match k with 4 => flag_is_set now | 6 => In Terminates (map fst (behaviors now)) | _ => False end.
Definition discards (before : list bool) (now : time_step action) (k : nat) : Prop :=
  match k with
  | 1 => compose now = Fails
  | 2 => ~ Forall (fun holds => holds = true) (always now)
  | 3 => In Fails (monitors now)
  | 5 => In Fails (map fst (behaviors now))
  | _ => ends now k /\ ~ all_satisfied before now
  end.

(** No step before `k` decides. *)
Definition reaches (before : list bool) (now : time_step action) (k : nat) : Prop :=
  forall j, j < k -> ~ discards before now j /\ ~ ends now j.

(** The verdict of the first step that decides. *)
Definition first_decision (before : list bool) (now : time_step action) (found : verdict action) : Prop :=
  match found with
  | Discarded k => discards before now k /\ reaches before now k
  | Terminated k => ends now k /\ all_satisfied before now /\ reaches before now k
  | Acts actions => actions = map snd (behaviors now) /\ reaches before now 7
  end.

Ltac up_to J := intros [|[|[|[|[|[|[|j]]]]]]] J; try lia; simpl.

Lemma the_policy_finds_the_first_decision before now : first_decision before now (policy before now).
Proof.
  assert (forall k, (k = 4 \/ k = 6) /\ ends now k -> reaches before now k ->
    first_decision before now (if all (seen before (eventually now)) then Terminated k else Discarded k)) as final.
  { intros k [K E] R. destruct (all _) eqn:A; [apply all_forall in A; exact (conj E (conj A R))|].
    rewrite <- not_true_iff_false, all_forall in A. fold (all_satisfied before now) in A. split; [|exact R].
    destruct K as [-> | ->]; exact (conj E A). }
  unfold policy, check_flag.
  destruct (run_all [compose now]) as [c|] eqn:C.
  2: { apply run_all_none in C as [C|[]]. split; [exact C|]. up_to J; intuition. }
  apply run_all_some in C as [NC C]. assert (compose now <> Fails) as NC' by (intro E; apply NC; now left).
  assert (c = true <-> compose now = Terminates) as C' by (rewrite C; simpl; tauto). clear C NC.
  destruct (all (always now)) eqn:A.
  2: { rewrite <- not_true_iff_false, all_forall in A. split; [exact A|]. up_to J; intuition. }
  apply all_forall in A.
  destruct (run_all (monitors now)) as [m|] eqn:M.
  2: { apply run_all_none in M. split; [exact M|]. up_to J; intuition. }
  apply run_all_some in M as [NM M].
  assert (c || is_over now || m = true <-> flag_is_set now) as F
    by (unfold flag_is_set; rewrite !orb_true_iff, C', M; tauto).
  destruct (c || is_over now || m).
  { assert (flag_is_set now) by now apply F. apply final; [auto|]. up_to J; intuition. }
  assert (~ flag_is_set now) as NF by (rewrite <- F; discriminate). clear F.
  destruct (run_all (map fst (behaviors now))) as [b|] eqn:B.
  2: { apply run_all_none in B. split; [exact B|]. up_to J; intuition. }
  apply run_all_some in B as [NB B].
  destruct b.
  { assert (In Terminates (map fst (behaviors now))) by now apply B. apply final; [auto|]. up_to J; intuition. }
  split; [reflexivity|]. assert (~ In Terminates (map fst (behaviors now))) by (rewrite <- B; discriminate). up_to J; intuition.
Qed.

Lemma the_first_decision_is_one before now one another :
  first_decision before now one -> first_decision before now another -> one = another.
Proof.
  assert (forall j k, ends now j \/ discards before now j -> reaches before now k -> k <= j) as First.
  { intros j k D R. destruct (le_lt_dec k j) as [L|L]; [exact L|]. destruct (R j L); tauto. }
  assert (forall k, ends now k \/ discards before now k -> k < 7) as Seven.
  { intros k. do 7 (destruct k; [lia|]). simpl. tauto. }
  assert (forall k, ends now k -> discards before now k -> ~ all_satisfied before now) as Both.
  { intros k. do 7 (destruct k; [simpl; tauto|]). simpl. tauto. }
  intros X Y; destruct one as [j|j|a], another as [k|k|a']; simpl in X, Y.
  - destruct X as [X RX], Y as [Y RY]. f_equal. apply Nat.le_antisymm; eapply First; eauto.
  - destruct X as [X RX], Y as (Y & S & RY). assert (j = k) as -> by (apply Nat.le_antisymm; eapply First; eauto). now destruct (Both k Y X).
  - destruct X as [X _], Y as [_ R]. pose proof (Seven j (or_intror X)). pose proof (First j 7 (or_intror X) R). lia.
  - destruct X as (X & S & RX), Y as [Y RY]. assert (j = k) as -> by (apply Nat.le_antisymm; eapply First; eauto). now destruct (Both k X Y).
  - destruct X as (X & _ & RX), Y as (Y & _ & RY). f_equal. apply Nat.le_antisymm; eapply First; eauto.
  - destruct X as [X _], Y as [_ R]. pose proof (Seven j (or_introl X)). pose proof (First j 7 (or_introl X) R). lia.
  - destruct Y as [Y _], X as [_ R]. pose proof (Seven k (or_intror Y)). pose proof (First k 7 (or_intror Y) R). lia.
  - destruct Y as [Y _], X as [_ R]. pose proof (Seven k (or_introl Y)). pose proof (First k 7 (or_introl Y) R). lia.
  - destruct X as [-> _], Y as [-> _]. reflexivity.
Qed.

Theorem the_verdict_is_that_of_the_first_step_that_decides before now found :
  policy before now = found <-> first_decision before now found.
Proof.
  pose proof (the_policy_finds_the_first_decision before now) as P. split; [now intros <-|].
  now apply the_first_decision_is_one.
Qed.

Theorem a_simulation_is_discarded_in_the_first_step_that_fails_if_none_before_ends_it before now k :
  policy before now = Discarded k <-> discards before now k /\ forall j, j < k -> ~ discards before now j /\ ~ ends now j.
Proof. apply the_verdict_is_that_of_the_first_step_that_decides. Qed.

Lemma reaches_step_4 before now :
  reaches before now 4 <-> compose now <> Fails /\ Forall (fun holds => holds = true) (always now) /\ ~ In Fails (monitors now).
Proof.
  split; [intro R|intros (C & A & M); up_to J; tauto].
  destruct (R 1) as [C _], (R 2) as [A _], (R 3) as [M _]; try lia; simpl in C, A, M. repeat split; auto.
  rewrite <- all_forall in *. destruct (all (always now)); [reflexivity|now destruct A].
Qed.

Lemma reaches_step_6 before now : reaches before now 6 <-> nothing_failed now /\ ~ flag_is_set now.
Proof.
  unfold nothing_failed. split.
  - intro R. assert (reaches before now 4) as Q by (intros j J; apply R; lia). apply reaches_step_4 in Q.
    destruct (R 4) as [_ F], (R 5) as [B _]; try lia. simpl in F, B. tauto.
  - intros [(C & A & M & B) F]. up_to J; tauto.
Qed.

Lemma reaches_step_7 before now :
  reaches before now 7 <-> nothing_failed now /\ ~ flag_is_set now /\ ~ In Terminates (map fst (behaviors now)).
Proof.
  split.
  - intro R. assert (reaches before now 6) as Q by (intros j J; apply R; lia). apply reaches_step_6 in Q.
    destruct (R 6) as [_ T]; [lia|]. simpl in T. tauto.
  - intros (N & F & T) j J. destruct (Nat.eq_dec j 6) as [->|D]; [simpl; tauto|].
    apply (proj2 (reaches_step_6 before now)); [tauto|lia].
Qed.

Theorem a_simulation_terminates_in_step_4_whatever_the_behaviors_do before now :
  policy before now = Terminated 4 <->
  compose now <> Fails /\ Forall (fun holds => holds = true) (always now) /\ ~ In Fails (monitors now) /\
  flag_is_set now /\ all_satisfied before now.
Proof. rewrite the_verdict_is_that_of_the_first_step_that_decides. simpl. rewrite reaches_step_4. tauto. Qed.

Theorem a_simulation_terminates_in_step_6_exactly_if_a_behavior_ends_it_where_nothing_failed_or_ended_it_before before now :
  policy before now = Terminated 6 <->
  nothing_failed now /\ ~ flag_is_set now /\ In Terminates (map fst (behaviors now)) /\ all_satisfied before now.
Proof. rewrite the_verdict_is_that_of_the_first_step_that_decides. simpl. rewrite reaches_step_6. tauto. Qed.

Theorem actions_are_returned_exactly_if_nothing_fails_and_nothing_ends_the_simulation before now actions :
  policy before now = Acts actions <->
  nothing_failed now /\ ~ flag_is_set now /\ ~ In Terminates (map fst (behaviors now)) /\ actions = map snd (behaviors now).
Proof. rewrite the_verdict_is_that_of_the_first_step_that_decides. simpl. rewrite reaches_step_7. tauto. Qed.

(** * Simulations that terminate *)

Definition kept_its_requirements (now : time_step action) : Prop :=
  compose now <> Fails /\ Forall (fun holds => holds = true) (always now) /\ ~ In Fails (monitors now).

Lemma terminated before now step : policy before now = Terminated step -> kept_its_requirements now /\ all (seen before (eventually now)) = true.
Proof.
  intro H; steps H; unfold kept_its_requirements; rewrite <- all_forall;
  repeat match goal with E : run_all _ = Some _ |- _ => apply run_all_some in E as [? _] end; repeat split; congruence || tauto.
Qed.

Theorem a_terminated_simulation_has_satisfied_every_require_always_at_every_time_step history : forall time before actions t step,
  simulation time before history = (actions, Over t step) ->
  Forall kept_its_requirements (firstn (S (length actions)) history) /\ length actions < length history.
Proof.
  induction history as [|now rest IH]; intros time before actions t step H; simpl in H; [discriminate|].
  destruct (policy before now) as [s|s|acts] eqn:P.
  - discriminate.
  - injection H as <- _ _. split; [|simpl; lia]. simpl. constructor; [|constructor]. now apply terminated in P.
  - destruct (simulation (S time) (seen before (eventually now)) rest) as [later e] eqn:R. injection H as <- ->.
    destruct (IH _ _ _ _ _ R) as [F L]. split; [|simpl; lia].
    change (firstn (S (length (acts :: later))) (now :: rest)) with (now :: firstn (S (length later)) rest).
    constructor; [|exact F]. apply no_action_is_returned_in_a_time_step_in_which_a_requirement_failed in P as [(A & B & C & _) _]. now repeat split.
Qed.

(** The k-th `require eventually` condition held in one of these time steps. *)
Definition held (k : nat) (history : list (time_step action)) : Prop := Exists (fun now => nth k (eventually now) false = true) history.

Lemma nth_seen k : forall before now, nth k (seen before now) false = true -> nth k before false = true \/ nth k now false = true.
Proof.
  induction k as [|k IH]; intros [|b before] [|n now] H; simpl in *; try discriminate; [now apply orb_prop in H|now apply IH].
Qed.

Lemma length_seen : forall before now, length before = length now -> length (seen before now) = length before.
Proof. induction before; intros [|n now] H; simpl in *; try discriminate; try reflexivity. now rewrite IHbefore by lia. Qed.

Theorem a_terminated_simulation_has_satisfied_every_require_eventually_at_some_time_step history : forall time before actions t step k,
  Forall (fun now => length (eventually now) = length before) history ->
  simulation time before history = (actions, Over t step) -> k < length before ->
  nth k before false = true \/ held k (firstn (S (length actions)) history).
Proof.
  induction history as [|now rest IH]; intros time before actions t step k N H K; simpl in H; [discriminate|].
  inversion N as [|? ? E F]; subst. destruct (policy before now) as [s|s|acts] eqn:P.
  - discriminate.
  - injection H as <- _ _. apply terminated in P as [_ A]. unfold all in A; rewrite forallb_forall in A.
    assert (nth k (seen before (eventually now)) false = true) as W.
    { apply A, nth_In. now rewrite length_seen. }
    apply nth_seen in W as [W|W]; [now left|right]. now constructor.
  - destruct (simulation (S time) (seen before (eventually now)) rest) as [later e] eqn:R. injection H as <- ->.
    assert (length (seen before (eventually now)) = length before) as L by now apply length_seen.
    destruct (IH _ _ _ _ _ k ltac:(now rewrite L) R ltac:(now rewrite L)) as [W|W].
    + apply nth_seen in W as [W|W]; [now left|right]. simpl; now constructor.
    + right. change (firstn (S (length (acts :: later))) (now :: rest)) with (now :: firstn (S (length later)) rest). now apply Exists_cons_tl.
Qed.

Lemma nothing_was_satisfied_before_the_beginning k n : nth k (repeat false n) false = false.
Proof. revert k; induction n as [|n IH]; intros [|k]; simpl; auto. Qed.

Theorem a_simulation_that_terminates_has_satisfied_every_require_eventually_since_it_began history n actions t step k :
  Forall (fun now => length (eventually now) = n) history ->
  simulation 0 (repeat false n) history = (actions, Over t step) -> k < n ->
  held k (firstn (S (length actions)) history).
Proof.
  intros N H K. rewrite <- (repeat_length false n) in N, K.
  destruct (a_terminated_simulation_has_satisfied_every_require_eventually_at_some_time_step _ _ _ _ _ _ _ N H K) as [B|B]; [|exact B].
  rewrite nothing_was_satisfied_before_the_beginning in B. discriminate.
Qed.

Lemma nth_seen_false k : forall before now, length before = length now -> nth k (seen before now) false = false ->
  nth k before false = false /\ nth k now false = false.
Proof.
  induction k as [|k IH]; intros [|b before] [|n now] L H; simpl in *; try discriminate; try (now split); [now apply orb_false_elim|].
  apply IH; [lia|exact H].
Qed.

Lemma not_all conditions : all conditions = false -> exists k, k < length conditions /\ nth k conditions false = false.
Proof.
  unfold all; induction conditions as [|[] rest IH]; simpl; intro H; [discriminate| |exists 0; split; [lia|reflexivity]].
  destruct (IH H) as (k & L & N). exists (S k); split; [lia|exact N].
Qed.

(** A `require eventually` condition was satisfied in no time step, the last one included. *)
Definition never_satisfied (before : list bool) (history : list (time_step action)) : Prop :=
  exists k, k < length before /\ nth k before false = false /\ ~ held k history.

Theorem a_simulation_that_is_thrown_away_failed_a_requirement history : forall time before actions t step,
  Forall (fun now => length (eventually now) = length before) history ->
  simulation time before history = (actions, Thrown_away t step) ->
  t = time + length actions /\
  ((exists now, nth_error history (length actions) = Some now /\ ~ nothing_failed now) \/ never_satisfied before (firstn (S (length actions)) history)).
Proof.
  induction history as [|now rest IH]; intros time before actions t step N H; simpl in H; [discriminate|].
  inversion N as [|? ? E F]; subst. destruct (policy before now) as [s|s|acts] eqn:P.
  - injection H as <- <- _. split; [simpl; lia|].
    destruct (all (seen before (eventually now))) eqn:A.
    + left; exists now; split; [reflexivity|]. intros (C & L & M & B). rewrite <- all_forall in L. unfold policy, check_flag in P. rewrite L, A in P.
      destruct (run_all (monitors now)) eqn:Q; [|now apply run_all_none in Q].
      destruct (run_all (map fst (behaviors now))) eqn:R; [|now apply run_all_none in R].
      destruct (compose now); simpl in P; try congruence; destruct (is_over now), b, b0; simpl in P; discriminate.
    + right. destruct (not_all _ A) as (k & L & K). rewrite length_seen in L by now symmetry.
      destruct (nth_seen_false k _ _ (eq_sym E) K) as [X Y]. exists k; repeat split; try assumption.
      intro W; apply Exists_cons in W as [W|W]; [congruence|now apply Exists_nil in W].
  - discriminate.
  - destruct (simulation (S time) (seen before (eventually now)) rest) as [later e] eqn:R. injection H as <- ->.
    assert (length (seen before (eventually now)) = length before) as L by now apply length_seen.
    destruct (IH _ _ _ _ _ ltac:(now rewrite L) R) as [T [(n & A & B)|(k & A & B & C)]].
    + split; [simpl; lia|left]. now exists n.
    + split; [simpl; lia|right]. rewrite L in A. destruct (nth_seen_false k _ _ (eq_sym E) B) as [X Y]. exists k; repeat split; try assumption.
      change (firstn (S (length (acts :: later))) (now :: rest)) with (now :: firstn (S (length later)) rest).
      intro W; apply Exists_cons in W as [W|W]; [congruence|now apply C].
Qed.

End Policy.
