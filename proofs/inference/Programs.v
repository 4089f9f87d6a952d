(** The machine's programs in the other theories' terms: what `Rejection` and `SoftRequirements` prove of distributions, proved of the runs that
    `kernel/Machine` finds. `inference/rejection.py` and `inference/enumeration.py`; the paper's "Semantics of a Scenic Program" and Section 5.1.

    - [rejection_sampling_of_a_program_has_its_law]: however many attempts are made at a scene;
    - [all_attempts_at_a_program_fail_with_a_power_of_its_rejection];
    - [a_soft_requirement_mixes_the_runs_with_and_without_it]: the rule "Soft Requirements" as the law of runs has it;
    - [a_soft_requirement_of_a_program_gives_the_law_under_run]: where `require B` would leave the scenes of an event, `require[p] B` gives
      them the probability q / (1 - p + p q), [a_soft_requirement_of_a_program_holds_with_q_over_1_minus_p_plus_p_q];
    - [the_claim_of_section_5_1_fails_for_this_program]: by running the machine. *)
From Coq Require Import Setoid Morphisms Lqa Bool.
From ScenicRef Require Import kernel.Distribution.
From ScenicRef Require scenes.SoftRequirements inference.Rejection.
From ScenicRef Require Import kernel.Machine.
Import ListNotations.
Open Scope Q_scope.

Section Programs.
Variable five_degrees : Q.
Variable noise : Q -> dist Q.
Variable boxes_intersect : bindings -> bindings -> bool.
Variable can_see : bindings -> bindings -> bool.
Variable at_the_end : bool.
Hypothesis the_noise_is_a_distribution : forall s, (0 < s)%Q -> is_distribution (noise s).

Let runs := runs five_degrees noise boxes_intersect can_see at_the_end.

Lemma weights_are_positive n c rs : runs n c = Some rs -> nonnegative (weighted rs).
Proof.
  intros H. apply Forall_map, Forall_forall. intros [a e] I. cbn. apply Qlt_le_weak.
  eapply every_run_has_a_positive_probability; [exact the_noise_is_a_distribution|]. eapply the_runs_found_are_the_runs; eauto.
Qed.

(** * Rejection *)

Lemma scenes_of_a_multiple x d : scenes (scale x d) ≈ scale x (scenes d).
Proof. intros f. now rewrite expect_scale, !expect_scenes, expect_scale. Qed.

Lemma scenes_are_of_accepted_runs d : scenes (given is_accepted d) ≈ scenes d.
Proof. intros f. rewrite !expect_scenes, expect_given. apply expect_ext. intros []; cbn; ring. Qed.

#[local] Instance scenes_respects : Proper (same ==> same) scenes.
Proof. intros d e H f. rewrite !expect_scenes. apply H. Qed.

(** The scenes that are found within so many attempts, at least one, where no run is an error. *)
Theorem rejection_sampling_of_a_program_has_its_law n c rs found attempts :
  runs n c = Some rs -> meaning rs = inl found ->
  normalised (scenes (Rejection.found (Rejection.sample is_accepted (weighted rs) (S attempts)))) ≈ found.
Proof.
  intros H M. unfold meaning in M. destruct (errors rs); [injection M as <-|discriminate]. unfold law.
  rewrite Rejection.n_attempts_find_a_multiple_of_what_one_finds, scenes_of_a_multiple, scenes_are_of_accepted_runs.
  apply normalised_forgets_a_factor. enough (0 < Rejection.geometric (pr (fun a => negb (is_accepted a)) (weighted rs)) (S attempts)) by lra.
  apply Rejection.geometric_is_positive, pr_nonnegative. eapply weights_are_positive; eauto.
Qed.

Theorem all_attempts_at_a_program_fail_with_a_power_of_its_rejection n c rs found attempts :
  runs n c = Some rs -> meaning rs = inl found ->
  pr Rejection.is_none (Rejection.sample is_accepted (weighted rs) attempts) == Rejection.power (pr is_rejected (weighted rs)) attempts.
Proof.
  intros H M. rewrite Rejection.all_attempts_fail_with_the_nth_power.
  assert (pr (fun a => negb (is_accepted a)) (weighted rs) == pr is_rejected (weighted rs)) as E.
  { apply expect_ext_in. intros e w I. destruct e as [|r|e]; try reflexivity. exfalso.
    unfold meaning in M. destruct (errors rs) as [|? ?] eqn:W; [|discriminate]. clear M.
    apply in_map_iff in I as ([a e'] & [= E _] & I). cbn in E. subst e'.
    assert (In e (errors rs)) as J by (unfold errors; rewrite in_flat_map; exists (a, Failed e); split; [exact I|now left]).
    now rewrite W in J. }
  clear H M. induction attempts as [|k IH]; [reflexivity|]. cbn [Rejection.power]. now rewrite IH, E.
Qed.

(** * Soft requirements *)

Theorem a_soft_requirement_mixes_the_runs_with_and_without_it n line p b rest s enforced skipped :
  0 <= p <= 1 -> runs n (Execute (Require line b :: rest) s) = Some enforced -> runs n (Execute rest s) = Some skipped ->
  exists rs, runs (S n) (Execute (SoftRequire line p b :: rest) s) = Some rs /\
    weighted rs ≈ bind (coin p) (fun heads => if heads then weighted enforced else weighted skipped).
Proof.
  intros [P0 P1] E K. set (c := Execute (SoftRequire line p b :: rest) s).
  set (resume := fun v => if truth_of v then Execute (Require line b :: rest) s else Execute rest s).
  set (d := positive [(Truth true, p); (Truth false, 1 - p)]).
  assert (machine five_degrees noise boxes_intersect can_see at_the_end c = Draw d resume) as M.
  { unfold c. cbn. unfold throw. assert (Qle_bool 0 p && Qle_bool p 1 = true)%bool as ->; [|reflexivity].
    now apply andb_true_intro; split; apply Qle_bool_iff. }
  assert (forall v w, In (v, w) d -> exists heads, v = Truth heads) as T.
  { intros v w I. apply filter_In in I as [[I|[I|[]]] _]; injection I as <- _; eauto. }
  assert (exists rs, runs (S n) c = Some rs) as [rs H].
  { unfold runs in *. cbn [Machine.runs]. rewrite M. revert T. clear M. generalize 0%nat. induction d as [|[v w] d' IH]; intros i T; [eexists; reflexivity|].
    cbn [branches]. destruct (T v w (or_introl eq_refl)) as [heads ->].
    assert (exists one, Machine.runs five_degrees noise boxes_intersect can_see at_the_end n (resume (Truth heads)) = Some one) as [one ->]
      by (destruct heads; eauto).
    destruct (IH (S i)) as [others ->]; [intros u x J; apply (T u x); now right|]. eauto. }
  exists rs. split; [exact H|]. intros f.
  rewrite (the_distribution_at_a_draw_is_a_mixture _ _ _ _ _ _ _ _ _ _ M H f), !expect_bind, expect_coin.
  assert (forall g, expect g d == p * g (Truth true) + (1 - p) * g (Truth false)) as ->.
  { intros g. unfold d, positive. cbn [filter snd].
    assert (forall q, 0 <= q -> Qle_bool q 0 = true -> q == 0) as Z by (intros q L R; apply Qle_bool_iff in R; lra).
    destruct (Qle_bool p 0) eqn:A, (Qle_bool (1 - p) 0) eqn:B; cbn [negb]; rewrite ?expect_cons; cbn [expect fold_right];
      try apply Z in A; try apply Z in B; try lra; rewrite ?A, ?B; ring. }
  unfold runs in *. cbn [truth_of resume]. unfold resume. cbn [truth_of]. now rewrite E, K.
Qed.

(** `require B` would leave just the scenes of an event. *)
Theorem a_soft_requirement_of_a_program_gives_the_law_under_run n line p b rest s enforced skipped rs (event : scene -> bool) :
  0 <= p <= 1 -> runs n (Execute (Require line b :: rest) s) = Some enforced -> runs n (Execute rest s) = Some skipped ->
  runs (S n) (Execute (SoftRequire line p b :: rest) s) = Some rs ->
  scenes (weighted enforced) ≈ given event (scenes (weighted skipped)) ->
  law rs ≈ SoftRequirements.under_run (scenes (weighted skipped)) [(p, event)].
Proof.
  intros P E K H L.
  destruct (a_soft_requirement_mixes_the_runs_with_and_without_it n line p b rest s enforced skipped P E K) as (rs' & H' & W).
  rewrite H in H'. injection H' as <-. unfold law, SoftRequirements.under_run. apply normalised_respects. intros f.
  rewrite SoftRequirements.accepted_expectation_weighs_by_survival, expect_scenes, (W _), expect_bind, expect_coin, <- !expect_scenes.
  rewrite (L f), expect_given, <- !expect_times, <- expect_plus. apply expect_ext. intros found. cbn [SoftRequirements.survival].
  destruct (event found); cbn; ring.
Qed.

(** q is the probability of the event in the scenes of the program without the requirement. *)
Theorem a_soft_requirement_of_a_program_holds_with_q_over_1_minus_p_plus_p_q n line p b rest s enforced skipped rs (event : scene -> bool)
  (q := pr event (law skipped)) :
  0 <= p <= 1 -> runs n (Execute (Require line b :: rest) s) = Some enforced -> runs n (Execute rest s) = Some skipped ->
  runs (S n) (Execute (SoftRequire line p b :: rest) s) = Some rs ->
  scenes (weighted enforced) ≈ given event (scenes (weighted skipped)) ->
  0 < mass (scenes (weighted skipped)) -> ~ 1 - p + p * q == 0 ->
  pr event (law rs) == q / (1 - p + p * q).
Proof.
  intros P E K H L M D.
  rewrite (a_soft_requirement_of_a_program_gives_the_law_under_run n line p b rest s enforced skipped rs event P E K H L).
  assert (q == SoftRequirements.probability event (scenes (weighted skipped))) as Q by (unfold q, law; now rewrite pr_normalised).
  rewrite Q in *. now apply SoftRequirements.probability_under_run_is_q_over_1_minus_p_plus_p_q.
Qed.
End Programs.

(** "This ensures that the condition B will hold with probability at least p in the induced distribution of the Scenic program":

    ego = Object
    x = Discrete({0: 1, 1: 9})
    param x = x
    require[0.5] x < 1 *)
Definition this_program : list statement :=
  [Assign ego (Object [] []);
   Assign 1%nat (Discrete [(Constant (Number 0), 1); (Constant (Number 1), 9)]);
   Param 0%nat (Name 1%nat);
   SoftRequire 4%nat (1 # 2) (Binary (Compare Less) (Name 1%nat) (Constant (Number 1)))].
Definition below_1 (found : scene) : bool :=
  match lookup 0%nat (its_params found) with Some (Number q) => negb (Qle_bool 1 q) | _ => false end.

Theorem the_claim_of_section_5_1_fails_for_this_program :
  exists rs found, upright_runs false 100%nat this_program = Some rs /\ meaning rs = inl found /\ pr below_1 found == 2 # 11 /\ 2 # 11 < 1 # 2.
Proof.
  assert (match upright_runs false 100%nat this_program with
          | Some rs => match meaning rs with inl found => Qeq_bool (pr below_1 found) (2 # 11) | inr _ => false end
          | None => false end = true) as C by (vm_compute; reflexivity).
  destruct (upright_runs false 100%nat this_program) as [rs|]; [|discriminate]. exists rs.
  destruct (meaning rs) as [found|]; [|discriminate]. exists found. apply Qeq_bool_iff in C. now repeat split.
Qed.
