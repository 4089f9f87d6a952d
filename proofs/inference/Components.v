(** Factorised rejection of any tree of components: `inference/batch/factorised_rejection.py`. (`Rejection` has that of two.)

    A component is draws of its own, the components within it, and a requirement about all these draws. It is drawn until its requirement holds,
    and whenever it is drawn anew, so are the components within it, each of them until what is required of it alone holds. The draws of different
    components are independent. What is found has the distribution of all draws together, given that all requirements hold
    ([drawing_components_apart_gives_the_distribution_of_drawing_all_together]). *)
From Coq Require Import Setoid Morphisms Bool Lqa.
From ScenicRef Require Import kernel.Distribution inference.Rejection.
Import ListNotations.
Open Scope Q_scope.

Section Components.
Context {A : Type}.

(** One draw after the other. *)
Fixpoint all_of {B} (ds : list (dist B)) : dist (list B) :=
  match ds with
  | [] => ret []
  | d :: ds => bind d (fun b => bind (all_of ds) (fun bs => ret (b :: bs)))
  end.

Inductive component : Type := Component (own : list (dist A)) (parts : list component) (requirement : list A -> bool).

(** Each part by itself until it is accepted; then the own draws, and all again until the requirement holds. *)
Fixpoint drawn_apart (c : component) : dist (list A) :=
  match c with
  | Component own parts requirement =>
      desired requirement (bind (all_of own) (fun a => bind (all_of (map drawn_apart parts)) (fun found => ret (a ++ concat found))))
  end.

(** All draws of it, once, and whether all requirements hold, those of the parts included. *)
Fixpoint drawn_together (c : component) : dist (list A * bool) :=
  match c with
  | Component own parts requirement =>
      bind (all_of own) (fun a => bind (all_of (map drawn_together parts)) (fun found =>
        let draws := a ++ concat (map fst found) in ret (draws, forallb snd found && requirement draws)))
  end.

(** Each requirement can be met, by what is left of the parts. *)
Fixpoint can_be_met (c : component) : Prop :=
  match c with
  | Component own parts requirement =>
      (fix each parts := match parts with [] => True | part :: rest => can_be_met part /\ each rest end) parts /\
      ~ pr requirement (bind (all_of own) (fun a => bind (all_of (map drawn_apart parts)) (fun found => ret (a ++ concat found)))) == 0
  end.

(** The one is the other, given that all requirements hold, but for a factor. *)
Definition is_a_multiple (c : component) : Prop :=
  exists k, ~ k == 0 /\ forall f, expect f (drawn_apart c) == k * expect (fun r => indicator (snd r) * f (fst r)) (drawn_together c).

Lemma parts_are_multiples parts : Forall is_a_multiple parts ->
  exists k, ~ k == 0 /\ forall f, expect f (all_of (map drawn_apart parts))
    == k * expect (fun found => indicator (forallb snd found) * f (map fst found)) (all_of (map drawn_together parts)).
Proof.
  induction 1 as [|part parts (k & K & E) F (l & L & G)].
  - exists 1. split; [discriminate|]. intros f. cbn [map all_of]. rewrite !expect_ret. cbn. ring.
  - exists (k * l). split; [intros Z; apply Qmult_integral in Z as [Z|Z]; auto|]. intros f. cbn [map all_of]. rewrite !expect_bind, E.
    rewrite <- !Qmult_assoc. apply Qmult_comp; [reflexivity|]. rewrite <- expect_times. apply expect_ext. intros [a b]. cbn [fst snd].
    rewrite !expect_bind, (expect_ext _ _ (fun found => f (a :: found))) by (intros found; apply expect_ret). rewrite G.
    transitivity (l * expect (fun found => indicator b * (indicator (forallb snd found) * f (a :: map fst found))) (all_of (map drawn_together parts)));
      [rewrite expect_times; ring|].
    apply Qmult_comp; [reflexivity|]. apply expect_ext. intros found. rewrite expect_ret. cbn [map fst snd forallb].
    destruct b, (forallb snd found); cbn; ring.
Qed.

Lemma a_component_is_a_multiple : forall c, can_be_met c -> is_a_multiple c.
Proof.
  fix IH 1. intros [own parts requirement] M. cbn [can_be_met] in M. destruct M as [P R].
  assert (Forall is_a_multiple parts) as F.
  { clear R. revert P. induction parts as [|part parts IHp]; intros P; [constructor|]. destruct P as [P Q]. constructor; [now apply IH|now apply IHp]. }
  clear IH P. destruct (parts_are_multiples parts F) as (k & K & E). unfold is_a_multiple. cbn [drawn_apart drawn_together].
  set (apart := bind (all_of own) _) in *. set (together := bind (all_of own) _).
  assert (forall f, expect (fun draws => indicator (requirement draws) * f draws) apart
    == k * expect (fun r => indicator (snd r) * f (fst r)) together) as W.
  { intros f. unfold apart, together. rewrite !expect_bind, <- expect_times. apply expect_ext. intros a. rewrite !expect_bind.
    rewrite (expect_ext _ _ (fun found => indicator (requirement (a ++ concat found)) * f (a ++ concat found)))
      by (intros found; apply expect_ret).
    rewrite E. apply Qmult_comp; [reflexivity|]. apply expect_ext. intros found. rewrite expect_ret. cbn [fst snd].
    destruct (forallb snd found), (requirement _); cbn; ring. }
  exists (/ pr requirement apart * k). split.
  - intros Z. apply Qmult_integral in Z as [Z|Z]; [|auto]. apply R. now rewrite <- Qinv_involutive, Z.
  - intros f. rewrite expect_desired, W. unfold Qdiv. ring.
Qed.

Theorem drawing_components_apart_gives_the_distribution_of_drawing_all_together c :
  can_be_met c -> normalised (drawn_apart c) ≈ bind (desired snd (drawn_together c)) (fun r => ret (fst r)).
Proof.
  intros M. destruct (a_component_is_a_multiple c M) as (k & K & E). intros f.
  rewrite expect_normalised, expect_bind, expect_desired. unfold mass, pr. rewrite !E.
  set (x := expect (fun r => indicator (snd r) * f (fst r)) (drawn_together c)).
  assert (expect (fun a => indicator (snd a) * expect f (ret (fst a))) (drawn_together c) == x) as ->
    by (apply expect_ext; intros r; now rewrite expect_ret).
  assert (expect (fun r => indicator (snd r) * 1) (drawn_together c) == expect (fun r => indicator (snd r)) (drawn_together c)) as ->
    by (apply expect_ext; intros; ring).
  unfold Qdiv. rewrite Qinv_mult_distr. set (y := / expect _ _). field. exact K.
Qed.
End Components.
