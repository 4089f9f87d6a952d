(** The move `step` of inference/moves/proposals.py, and where chains can get: the moves redraw and exchange are in `Rejection`.

    "they move by a normal step, around the unit interval as if its ends met": here the interval is a circle of n points, and the law of a step any
    that is symmetric. The desired distribution stays as it is ([steps_around_a_circle_leave_the_desired_distribution_invariant]), whatever
    the other draws are. But chains need not get everywhere: of draws that have to be equal none can be changed alone
    ([chains_need_not_reach_every_accepted_run]), for which chains begin at states that splitting found. They get where moves of positive
    probability lead ([a_chain_reaches_what_its_moves_lead_to]). *)
From Coq Require Import ZArith Lia Permutation Setoid Morphisms Bool Lqa FinFun.
From ScenicRef Require Import kernel.Distribution inference.Rejection.
Import ListNotations.
Open Scope Q_scope.

(** * Steps *)

Section Steps.
Context {A K : Type} (law : dist K) (go : K -> A -> A) (back : K -> K).

(** A step: how far is drawn apart from where one is. *)
Definition step (a : A) : dist A := bind law (fun k => ret (go k a)).

(** A step back is as likely, and takes one back; all steps take the prior to itself. *)
Theorem symmetric_steps_are_reversible d :
  (forall k a, go (back k) (go k a) = a) -> bind law (fun k => ret (back k)) ≈ law -> (forall k, bind d (fun a => ret (go k a)) ≈ d) ->
  reversible d step.
Proof.
  intros B S D f. unfold step.
  assert (forall g : A -> A -> Q, expect (fun a => expect (fun b => g a b) (bind law (fun k => ret (go k a)))) d
    == expect (fun k => expect (fun a => g a (go k a)) d) law) as open.
  { intros g. rewrite <- expect_swap. apply expect_ext. intros a. rewrite expect_bind. apply expect_ext. intros k. apply expect_ret. }
  rewrite (open f), (open (fun a b => f b a)).
  transitivity (expect (fun k => expect (fun a => f a (go k a)) d) (bind law (fun k => ret (back k)))); [symmetry; apply (S (fun k => _))|].
  rewrite expect_bind. apply expect_ext. intros k. rewrite expect_ret.
  transitivity (expect (fun a => f a (go (back k) a)) (bind d (fun a => ret (go k a)))); [symmetry; apply (D k (fun a => _))|].
  rewrite expect_bind. apply expect_ext. intros a. now rewrite expect_ret, B.
Qed.

Lemma step_is_never_stuck : mass law == 1 -> never_stuck step.
Proof. intros M a. unfold step. now rewrite bind_preserves_mass. Qed.

Theorem symmetric_steps_leave_the_desired_distribution_invariant accepts d :
  mass law == 1 -> (forall k a, go (back k) (go k a) = a) -> bind law (fun k => ret (back k)) ≈ law ->
  (forall k, bind d (fun a => ret (go k a)) ≈ d) -> invariant (desired accepts d) (where_accepted accepts step).
Proof.
  intros M B S D. apply moves_within_the_accepted_runs_leave_the_desired_distribution_invariant; [now apply step_is_never_stuck|].
  now apply symmetric_steps_are_reversible.
Qed.
End Steps.

(** * Around a circle *)

(** The points 0, 1, ..., n - 1, each as likely, and k steps from one of them. *)
Definition points (n : nat) : list Z := map Z.of_nat (seq 0 n).
Definition circle (n : nat) : dist Z := map (fun a => (a, / inject_Z (Z.of_nat n))) (points n).
Definition around (n : nat) (k a : Z) : Z := Z.modulo (a + k) (Z.of_nat n).

Lemma in_points n a : In a (points n) <-> (0 <= a < Z.of_nat n)%Z.
Proof.
  unfold points. rewrite in_map_iff. split.
  - intros (m & <- & I). apply in_seq in I. lia.
  - intros B. exists (Z.to_nat a). split; [lia|]. apply in_seq. lia.
Qed.

Lemma shifted_points_are_the_points n k : Permutation (map (around n k) (points n)) (points n).
Proof.
  assert (NoDup (points n)) as N by (apply Injective_map_NoDup; [intros x y; apply Nat2Z.inj|apply seq_NoDup]).
  apply Permutation_sym, NoDup_Permutation_bis.
  - exact N.
  - now rewrite map_length.
  - intros a I. pose proof I as J. apply in_points in J. apply in_map_iff. exists (around n (- k) a). unfold around. split.
    + rewrite Zplus_mod_idemp_l. replace (a + - k + k)%Z with a by ring. apply Z.mod_small. lia.
    + apply in_points. apply Z.mod_pos_bound. lia.
Qed.

Lemma expect_of_equally_likely A (f : A -> Q) c l l' :
  Permutation l l' -> expect f (map (fun a => (a, c)) l) == expect f (map (fun a => (a, c)) l').
Proof.
  intros P. induction P as [|a l l' P IH|a b l|l l' l'' P IH P' IH']; cbn [map]; [reflexivity| | |now rewrite IH].
  - now rewrite !expect_cons, IH.
  - rewrite !expect_cons. ring.
Qed.

Lemma steps_take_the_circle_to_itself n k : bind (circle n) (fun a => ret (around n k a)) ≈ circle n.
Proof.
  intros f. rewrite expect_bind. unfold circle at 2.
  rewrite <- (expect_of_equally_likely _ f _ _ _ (shifted_points_are_the_points n k)), map_map. unfold circle.
  induction (points n) as [|a l IH]; [reflexivity|]. cbn [map]. rewrite !expect_cons, IH. now rewrite expect_ret.
Qed.

(** A state is a point of the circle and what else was drawn; a step goes k points on, or back. Where it is no point, nothing happens. *)
Definition stepped {B} (n : nat) (k : Z) (ab : Z * B) : Z * B :=
  if ((0 <=? fst ab)%Z && (fst ab <? Z.of_nat n)%Z)%bool then (around n k (fst ab), snd ab) else ab.

Lemma stepped_back B n k (ab : Z * B) : stepped n (- k) (stepped n k ab) = ab.
Proof.
  destruct ab as [a b]. unfold stepped. cbn [fst snd]. destruct (0 <=? a)%Z eqn:L, (a <? Z.of_nat n)%Z eqn:R; cbn [andb fst snd]; rewrite ?L, ?R; auto.
  apply Z.leb_le in L. apply Z.ltb_lt in R. unfold around at 1 2. pose proof (Z.mod_pos_bound (a + k) (Z.of_nat n) ltac:(lia)) as [P Q].
  apply Z.leb_le in P. apply Z.ltb_lt in Q. rewrite P, Q. cbn [andb]. unfold around. rewrite Zplus_mod_idemp_l.
  replace (a + k + - k)%Z with a by ring. f_equal. apply Z.mod_small. lia.
Qed.

Theorem steps_around_a_circle_leave_the_desired_distribution_invariant B n (law : dist Z) (e : dist B) accepts :
  mass law == 1 -> bind law (fun k => ret (- k)%Z) ≈ law ->
  invariant (desired accepts (product (circle n) e)) (where_accepted accepts (step law (stepped n))).
Proof.
  intros M S. apply (symmetric_steps_leave_the_desired_distribution_invariant law (stepped n) Z.opp); auto using stepped_back.
  intros k f. rewrite expect_bind, !expect_product.
  transitivity (expect (fun a => expect (fun b => f (a, b)) e) (bind (circle n) (fun a => ret (around n k a))));
    [|apply (steps_take_the_circle_to_itself n k (fun a => _))].
  rewrite expect_bind. unfold circle. apply expect_ext_in. intros a w I. rewrite expect_ret. apply expect_ext. intros b. rewrite expect_ret.
  apply in_map_iff in I as (a' & [= -> _] & I). apply in_points in I. unfold stepped. cbn [fst snd].
  assert ((0 <=? a)%Z = true) as -> by (apply Z.leb_le; lia). assert ((a <? Z.of_nat n)%Z = true) as -> by (apply Z.ltb_lt; lia). reflexivity.
Qed.

(** * Where chains get *)

(** x = Uniform(0, 1), y = Uniform(0, 1), require x == y: one of them is redrawn, or the two are exchanged. *)
Definition both_bits : dist bool := coin (1 # 2).
Definition alike (ab : bool * bool) : bool := Bool.eqb (fst ab) (snd ab).
Definition one_of_three (ab : bool * bool) : dist (bool * bool) :=
  bind [(0, 1 # 3); (1, 1 # 3); (2, 1 # 3)]%nat (fun kind =>
    match kind with
    | 0%nat => bind both_bits (fun a => ret (a, snd ab))
    | 1%nat => bind both_bits (fun b => ret (fst ab, b))
    | _ => ret (snd ab, fst ab)
    end).

Lemma nothing_moves f ab : alike ab = true -> expect f (where_accepted alike one_of_three ab) == f ab.
Proof.
  intros E. unfold where_accepted. rewrite expect_bind, (expect_ext_in _ _ (fun _ => f ab)).
  - rewrite expect_constant. assert (mass (one_of_three ab) == 1) as -> by (destruct ab as [[] []]; reflexivity). ring.
  - intros b w I. rewrite expect_ret. destruct ab as [[] []]; try discriminate E; cbn in I;
      repeat (destruct I as [I|I]; [injection I as <- <-; reflexivity|]); destruct I.
Qed.

Theorem chains_need_not_reach_every_accepted_run n :
  pr (fun ab => fst ab) (chain (where_accepted alike one_of_three) n (false, false)) == 0 /\
  pr (fun ab => fst ab) (desired alike (product both_bits both_bits)) == 1 # 2.
Proof.
  split; [|reflexivity]. unfold pr. induction n as [|n IH]; [reflexivity|]. cbn [chain]. now rewrite expect_bind, nothing_moves.
Qed.

(** Some moves, each of which has a positive probability, lead from one state to another. *)
Inductive leads_to {A} (move : A -> dist A) : nat -> A -> A -> Prop :=
| already_there a : leads_to move 0 a a
| after_a_move n a b c w : In (b, w) (move a) -> 0 < w -> leads_to move n b c -> leads_to move (S n) a c.

Lemma in_bind A B (d : dist A) (k : A -> dist B) a w b v : In (a, w) d -> In (b, v) (k a) -> In (b, w * v) (bind d k).
Proof. intros I J. apply in_flat_map. exists (a, w). split; [exact I|]. apply in_map_iff. now exists (b, v). Qed.

Lemma the_expectation_is_at_least_one_summand A (f : A -> Q) d a w :
  nonnegative d -> (forall a, 0 <= f a) -> In (a, w) d -> w * f a <= expect f d.
Proof.
  intros N F I. induction N as [|[b v] d V N IH]; [destruct I|]. rewrite expect_cons. cbn in V. pose proof (expect_nonnegative _ f d N F).
  pose proof (F b). assert (0 <= v * f b) by (now apply Qmult_le_0_compat).
  destruct I as [[= -> ->]|I]; [lra|]. specialize (IH I). lra.
Qed.

Theorem a_chain_reaches_what_its_moves_lead_to A (move : A -> dist A) (is_c : A -> bool) n a c :
  (forall a, nonnegative (move a)) -> leads_to move n a c -> is_c c = true -> 0 < pr is_c (chain move n a).
Proof.
  intros N L E. assert (forall n a, nonnegative (chain move n a)) as C.
  { intros m. induction m as [|m IH]; intros b; cbn [chain]; [apply nonnegative_ret|now apply nonnegative_bind]. }
  unfold pr. induction L as [c|n a b c w I W L IH]; cbn [chain].
  - rewrite expect_ret, E. reflexivity.
  - rewrite expect_bind. specialize (IH E).
    eapply Qlt_le_trans; [|eapply the_expectation_is_at_least_one_summand; [apply N|intros x|exact I]].
    + now apply Qmult_lt_0_compat.
    + apply (pr_nonnegative _ is_c (chain move n x) (C n x)).
Qed.

(** So where accepted runs are to be had from each other by changing coordinates one by one within the accepted ones, chains reach them. *)
Theorem a_redraw_leads_to_every_accepted_state_that_differs_in_its_coordinate A B (d : dist A) accepts a a' (b : B) w :
  In (a', w) d -> 0 < w -> accepts (a', b) = true -> leads_to (where_accepted accepts (redraw d)) 1 (a, b) (a', b).
Proof.
  intros I W E. apply after_a_move with (a', b) (w * 1 * 1); [|lra|constructor]. unfold where_accepted, redraw.
  apply in_bind with (a', b); [|rewrite E; now left]. apply in_bind with a'; [exact I|now left].
Qed.
