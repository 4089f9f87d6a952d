(** Finite distributions: weighted lists of values, with rational weights.

    A run of a program whose draws have finitely many values is a list of choices, and
    its weight is the product of their probabilities (the paper, "Semantics of a Scenic
    Program"; `Leaf` in inference/enumeration.py). A run that gets stuck is left out, so
    that the mass of a distribution, the sum of its weights, may be below 1.

    All that is ever asked of a distribution is the expectation of functions; two that
    give every function the same expectation are [same]. *)
From Coq Require Export QArith List.
From Coq Require Import Setoid Morphisms Lqa Bool.
Import ListNotations.
Open Scope Q_scope.

Definition dist (A : Type) : Type := list (A * Q).

Definition ret {A} (a : A) : dist A := [(a, 1)].
Definition stuck {A} : dist A := [].
Definition scale {A} (c : Q) (d : dist A) : dist A :=
  map (fun aw => (fst aw, c * snd aw)) d.
Definition bind {A B} (d : dist A) (k : A -> dist B) : dist B :=
  flat_map (fun aw => scale (snd aw) (k (fst aw))) d.

(** The draws that programs are made of: a coin that shows heads with probability [p],
    and values with weights that need not add up to 1, as those of `Discrete`. *)
Definition coin (p : Q) : dist bool := [(true, p); (false, 1 - p)].
Definition given {A} (E : A -> bool) (d : dist A) : dist A :=
  bind d (fun a => if E a then ret a else stuck).
Definition product {A B} (d : dist A) (e : dist B) : dist (A * B) :=
  bind d (fun a => bind e (fun b => ret (a, b))).

(** [Qred] keeps fractions small where they are computed; [expect_cons] is how it is meant. *)
Definition expect {A} (f : A -> Q) (d : dist A) : Q :=
  fold_right (fun aw sum => Qred (snd aw * f (fst aw) + sum)) 0 d.
Definition indicator (b : bool) : Q := if b then 1 else 0.
Definition mass {A} (d : dist A) : Q := expect (fun _ => 1) d.
Definition pr {A} (E : A -> bool) (d : dist A) : Q := expect (fun a => indicator (E a)) d.
Definition normalised {A} (d : dist A) : dist A := scale (/ mass d) d.

Definition nonnegative {A} (d : dist A) : Prop := Forall (fun aw => 0 <= snd aw) d.
Definition same {A} (d e : dist A) : Prop := forall f, expect f d == expect f e.
Infix "≈" := same (at level 70).

#[export] Instance same_is_an_equivalence A : Equivalence (@same A).
Proof.
  split; [now intros d f | now intros d e H f | intros d e g H I f].
  now rewrite (H f), (I f).
Qed.

(** ** Expectations *)

Lemma expect_cons A (f : A -> Q) a w d : expect f ((a, w) :: d) == w * f a + expect f d.
Proof. apply Qred_correct. Qed.

Lemma expect_ext A (f g : A -> Q) d : (forall a, f a == g a) -> expect f d == expect g d.
Proof.
  intros H. induction d as [|[a w] d IH]; [reflexivity|].
  now rewrite !expect_cons, (H a), IH.
Qed.

#[export] Instance expect_respects A :
  Proper (pointwise_relation A Qeq ==> eq ==> Qeq) (@expect A).
Proof. intros f g H d _ <-. now apply expect_ext. Qed.

(** The functions need agree only on the values that occur. *)
Lemma expect_ext_in A (f g : A -> Q) d :
  (forall a w, In (a, w) d -> f a == g a) -> expect f d == expect g d.
Proof.
  intros H. induction d as [|[a w] d IH]; [reflexivity|].
  rewrite !expect_cons, (H a w) by now left. rewrite IH; [reflexivity|].
  intros b v I. apply (H b v). now right.
Qed.

Lemma expect_app A (f : A -> Q) d e : expect f (d ++ e) == expect f d + expect f e.
Proof.
  induction d as [|[a w] d IH]; [symmetry; apply Qplus_0_l|].
  cbn [app]. rewrite !expect_cons, IH. ring.
Qed.

Lemma expect_scale A (f : A -> Q) c d : expect f (scale c d) == c * expect f d.
Proof.
  induction d as [|[a w] d IH]; [symmetry; apply Qmult_0_r|].
  change (scale c ((a, w) :: d)) with ((a, c * w) :: scale c d).
  rewrite !expect_cons, IH. ring.
Qed.

Lemma expect_ret A (f : A -> Q) a : expect f (ret a) == f a.
Proof. unfold ret. rewrite expect_cons. cbn. ring. Qed.

Lemma expect_stuck A (f : A -> Q) : expect f stuck == 0.
Proof. reflexivity. Qed.

Lemma expect_if A (f : A -> Q) (b : bool) d e :
  expect f (if b then d else e) == if b then expect f d else expect f e.
Proof. now destruct b. Qed.

Lemma expect_bind A B (f : B -> Q) (d : dist A) k :
  expect f (bind d k) == expect (fun a => expect f (k a)) d.
Proof.
  induction d as [|[a w] d IH]; [reflexivity|].
  change (bind ((a, w) :: d) k) with (scale w (k a) ++ bind d k).
  now rewrite expect_app, expect_scale, IH, expect_cons.
Qed.

Lemma expect_coin p f : expect f (coin p) == p * f true + (1 - p) * f false.
Proof. unfold coin. rewrite !expect_cons. cbn [expect fold_right]. ring. Qed.

Lemma expect_given A (f : A -> Q) E d :
  expect f (given E d) == expect (fun a => indicator (E a) * f a) d.
Proof.
  unfold given. rewrite expect_bind. apply expect_ext. intros a.
  destruct (E a); rewrite ?expect_ret, ?expect_stuck; cbn; ring.
Qed.

Lemma expect_product A B (f : A * B -> Q) d e :
  expect f (product d e) == expect (fun a => expect (fun b => f (a, b)) e) d.
Proof.
  unfold product. rewrite expect_bind. apply expect_ext. intros a.
  rewrite expect_bind. apply expect_ext. intros b. apply expect_ret.
Qed.

(** Expectation is linear and monotone. *)
Lemma expect_plus A (f g : A -> Q) d :
  expect (fun a => f a + g a) d == expect f d + expect g d.
Proof. induction d as [|[a w] d IH]; [reflexivity|]. rewrite !expect_cons, IH. ring. Qed.

Lemma expect_times A c (f : A -> Q) d : expect (fun a => c * f a) d == c * expect f d.
Proof.
  induction d as [|[a w] d IH]; [symmetry; apply Qmult_0_r|].
  rewrite !expect_cons, IH. ring.
Qed.

Lemma expect_times_right A c (f : A -> Q) d : expect (fun a => f a * c) d == expect f d * c.
Proof. induction d as [|[a w] d IH]; [reflexivity|]. rewrite !expect_cons, IH. ring. Qed.

Lemma expect_constant A c (d : dist A) : expect (fun _ => c) d == c * mass d.
Proof. unfold mass. rewrite <- expect_times. apply expect_ext. intros _. ring. Qed.

Lemma expect_zero A (d : dist A) : expect (fun _ => 0) d == 0.
Proof. rewrite expect_constant. ring. Qed.

Lemma expect_monotone A (f g : A -> Q) d :
  nonnegative d -> (forall a, f a <= g a) -> expect f d <= expect g d.
Proof.
  intros N H. induction N as [|[a w] d Hw N IH]; [cbn; lra|].
  rewrite !expect_cons. cbn in Hw. pose proof (H a). nra.
Qed.

Lemma expect_nonnegative A (f : A -> Q) d :
  nonnegative d -> (forall a, 0 <= f a) -> 0 <= expect f d.
Proof. intros N H. rewrite <- (expect_zero A d). now apply expect_monotone. Qed.

(** The order of two draws that do not depend on each other does not matter. *)
Lemma expect_swap A B (f : A -> B -> Q) d e :
  expect (fun a => expect (f a) e) d == expect (fun b => expect (fun a => f a b) d) e.
Proof.
  induction d as [|[a w] d IH].
  - cbn. now rewrite expect_zero.
  - rewrite expect_cons, IH, <- expect_times, <- expect_plus. apply expect_ext. intros b.
    now rewrite expect_cons.
Qed.

(** ** The monad's laws *)

#[export] Instance bind_respects A B :
  Proper (same ==> pointwise_relation A same ==> same) (@bind A B).
Proof.
  intros d e H k l I f. rewrite !expect_bind, (H (fun a => expect f (k a))).
  apply expect_ext. intros a. apply (I a).
Qed.

Theorem bind_ret_left A B (a : A) (k : A -> dist B) : bind (ret a) k ≈ k a.
Proof. intros f. now rewrite expect_bind, expect_ret. Qed.

Theorem bind_ret_right A (d : dist A) : bind d ret ≈ d.
Proof. intros f. rewrite expect_bind. apply expect_ext. intros a. apply expect_ret. Qed.

Theorem bind_assoc A B C (d : dist A) (k : A -> dist B) (l : B -> dist C) :
  bind (bind d k) l ≈ bind d (fun a => bind (k a) l).
Proof.
  intros f. rewrite !expect_bind. apply expect_ext. intros a. now rewrite expect_bind.
Qed.

Theorem independent_draws_commute A B C (d : dist A) (e : dist B) (k : A -> B -> dist C) :
  bind d (fun a => bind e (k a)) ≈ bind e (fun b => bind d (fun a => k a b)).
Proof.
  intros f. rewrite !expect_bind.
  rewrite (expect_ext A _ (fun a => expect (fun b => expect f (k a b)) e))
    by (intros a; apply expect_bind).
  rewrite expect_swap. apply expect_ext. intros b. now rewrite expect_bind.
Qed.

(** ** Mass and probability *)

#[export] Instance mass_respects A : Proper (same ==> Qeq) (@mass A).
Proof. intros d e H. apply H. Qed.

#[export] Instance pr_respects A : Proper (eq ==> same ==> Qeq) (@pr A).
Proof. intros E _ <- d e H. apply H. Qed.

#[export] Instance scale_respects A : Proper (Qeq ==> same ==> same) (@scale A).
Proof. intros c c' H d e I f. now rewrite !expect_scale, H, (I f). Qed.

#[export] Instance given_respects A : Proper (eq ==> same ==> same) (@given A).
Proof. intros E _ <- d e H f. rewrite !expect_given. apply H. Qed.

#[export] Instance product_respects A B : Proper (same ==> same ==> same) (@product A B).
Proof.
  intros d d' H e e' I f. rewrite !expect_product, (H (fun a => expect (fun b => f (a, b)) e)).
  apply expect_ext. intros a. apply I.
Qed.

Lemma mass_of_bind A B (d : dist A) (k : A -> dist B) :
  mass (bind d k) == expect (fun a => mass (k a)) d.
Proof. apply expect_bind. Qed.

(** What never gets stuck, and goes on with what never gets stuck, never gets stuck. *)
Theorem bind_preserves_mass A B (d : dist A) (k : A -> dist B) :
  (forall a, mass (k a) == 1) -> mass (bind d k) == mass d.
Proof. intros H. rewrite mass_of_bind. now apply expect_ext. Qed.

Lemma mass_ret A (a : A) : mass (ret a) == 1.
Proof. reflexivity. Qed.

Lemma mass_coin p : mass (coin p) == 1.
Proof. unfold mass. rewrite expect_coin. ring. Qed.

Lemma mass_scale A c (d : dist A) : mass (scale c d) == c * mass d.
Proof. apply expect_scale. Qed.

Lemma mass_given A E (d : dist A) : mass (given E d) == pr E d.
Proof. unfold mass, pr. rewrite expect_given. apply expect_ext. intros a. ring. Qed.

Lemma mass_product A B (d : dist A) (e : dist B) : mass (product d e) == mass d * mass e.
Proof.
  unfold mass at 1. rewrite expect_product, expect_constant. unfold mass. ring.
Qed.

Lemma pr_scale A E c (d : dist A) : pr E (scale c d) == c * pr E d.
Proof. apply expect_scale. Qed.

Lemma pr_given A E F (d : dist A) : pr E (given F d) == pr (fun a => F a && E a) d.
Proof.
  unfold pr. rewrite expect_given. apply expect_ext. intros a.
  destruct (F a), (E a); cbn; ring.
Qed.

Lemma pr_true A (d : dist A) : pr (fun _ => true) d == mass d.
Proof. reflexivity. Qed.

Lemma pr_complement A E (d : dist A) : pr E d + pr (fun a => negb (E a)) d == mass d.
Proof.
  unfold pr. rewrite <- expect_plus. apply expect_ext. intros a. destruct (E a); cbn; ring.
Qed.

Lemma pr_nonnegative A E (d : dist A) : nonnegative d -> 0 <= pr E d.
Proof. intros N. apply expect_nonnegative; [trivial|]. intros a. destruct (E a); cbn; lra. Qed.

Lemma mass_nonnegative A (d : dist A) : nonnegative d -> 0 <= mass d.
Proof. intros N. now apply (pr_nonnegative A (fun _ => true)). Qed.

Lemma pr_monotone A (E F : A -> bool) d :
  nonnegative d -> (forall a, E a = true -> F a = true) -> pr E d <= pr F d.
Proof.
  intros N H. apply expect_monotone; [trivial|]. intros a. specialize (H a).
  destruct (E a), (F a); cbn; lra.
Qed.

Lemma pr_at_most_mass A E (d : dist A) : nonnegative d -> pr E d <= mass d.
Proof. intros N. apply (pr_monotone A E (fun _ => true)); trivial. Qed.

(** ** Weights that are not negative *)

Lemma nonnegative_scale A c (d : dist A) : 0 <= c -> nonnegative d -> nonnegative (scale c d).
Proof.
  intros Hc N. unfold nonnegative, scale in *. rewrite Forall_map.
  apply (Forall_impl _ (P := fun aw => 0 <= snd aw)); [|trivial].
  intros [a w] Hw. cbn in *. now apply Qmult_le_0_compat.
Qed.

Lemma nonnegative_bind A B (d : dist A) (k : A -> dist B) :
  nonnegative d -> (forall a, nonnegative (k a)) -> nonnegative (bind d k).
Proof.
  intros N H. induction N as [|[a w] d Hw N IH]; cbn; [constructor|].
  apply Forall_app. split; [now apply nonnegative_scale|trivial].
Qed.

Lemma nonnegative_ret A (a : A) : nonnegative (ret a).
Proof. repeat constructor. cbn. lra. Qed.

Lemma nonnegative_coin p : 0 <= p <= 1 -> nonnegative (coin p).
Proof. intros H. repeat constructor; cbn; lra. Qed.

Lemma nonnegative_given A E (d : dist A) : nonnegative d -> nonnegative (given E d).
Proof.
  intros N. apply nonnegative_bind; [trivial|]. intros a.
  destruct (E a); [apply nonnegative_ret | constructor].
Qed.

(** A distribution without mass gives nothing any weight. *)
Lemma expect_without_mass A (f : A -> Q) d : nonnegative d -> mass d == 0 -> expect f d == 0.
Proof.
  intros N. unfold mass. induction N as [|[a w] d Hw N IH]; [reflexivity|].
  rewrite !expect_cons. cbn in Hw. intros H.
  pose proof (mass_nonnegative A d N). unfold mass in *.
  assert (w == 0) as -> by lra. rewrite IH by lra. ring.
Qed.

(** ** Discarding what is stuck, and dividing by what remains *)

Lemma expect_normalised A (f : A -> Q) d : expect f (normalised d) == expect f d / mass d.
Proof. unfold normalised. rewrite expect_scale. unfold Qdiv. ring. Qed.

Lemma pr_normalised A E (d : dist A) : pr E (normalised d) == pr E d / mass d.
Proof. apply expect_normalised. Qed.

#[export] Instance normalised_respects A : Proper (same ==> same) (@normalised A).
Proof. intros d e H f. now rewrite !expect_normalised, (H f), H. Qed.

Theorem what_has_mass_has_mass_1_when_normalised A (d : dist A) : ~ mass d == 0 -> mass (normalised d) == 1.
Proof. intros H. unfold normalised. rewrite mass_scale. now field. Qed.

(** Where no run is accepted nothing is left: in Q, 1/0 is 0. *)
Theorem what_has_no_mass_has_none_when_normalised A (d : dist A) : mass d == 0 -> mass (normalised d) == 0.
Proof. intros H. unfold normalised. rewrite mass_scale, H. reflexivity. Qed.

Theorem what_has_mass_1_stays_the_same_when_normalised A (d : dist A) : mass d == 1 -> normalised d ≈ d.
Proof. intros H f. rewrite expect_normalised, H. field. Qed.

Theorem normalised_forgets_a_factor A c (d : dist A) :
  ~ c == 0 -> normalised (scale c d) ≈ normalised d.
Proof.
  intros H f. rewrite !expect_normalised, expect_scale, mass_scale.
  unfold Qdiv. rewrite Qinv_mult_distr.
  transitivity (c * / c * (expect f d * / mass d)); [ring|].
  rewrite Qmult_inv_r by trivial. ring.
Qed.
