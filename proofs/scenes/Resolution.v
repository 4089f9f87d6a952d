(** The paper's Algorithm 1, resolveSpecifiers: which specifier determines each property of an object, and in which order the specifiers
    are evaluated. The definitions mirror [semantics/scenes/resolution.py] phase by phase, down to the order of its results; [resolve]
    is the whole of it.

    It always ends, for Coq accepts no other function: with the ordered specifiers or with one of four errors.

    - [resolution_succeeds_exactly_when_no_property_is_specified_twice_and_dependencies_are_present_and_acyclic],
      [the_error_is_that_of_the_first_phase_that_finds_one],
      [the_property_specified_twice_is_the_first_that_is_and_its_specifiers_are_named_in_the_order_of_the_source],
      [the_property_specified_twice_optionally_is_the_first_that_is_and_all_its_specifiers_are_named],
      [the_missing_property_is_one_that_nothing_determines_and_what_depends_on_it_is_named],
      [what_waits_depends_on_what_waits_and_nothing_else_hangs_on_a_cycle],
      [the_graph_of_properties_is_acyclic_exactly_when_that_of_specifiers_is];
    - [each_property_is_determined_exactly_once], [each_property_is_determined_by_its_non_optional_specifier_else_its_optional_one_else_its_default],
      [the_object_has_the_properties_that_are_specified_or_have_a_default], [the_default_is_that_of_the_most_derived_class];
    - [every_dependency_is_determined_before_its_dependents];
    - [any_two_topological_orders_build_the_same_object], [each_value_is_computed_from_the_values_that_the_finished_object_has];
    - [the_order_of_specifiers_in_the_source_is_irrelevant].

    Two arguments of the Python are left out: [known], which a reading of the paper uses to ignore some optional specifications (here
    all count, as if it were None), and [absent], dependencies that may be missing (here none may). *)
From Coq Require Import List Arith Lia Permutation Relations.
From ScenicRef Require Import scenes.Ordering.
Import ListNotations.

(** * What is resolved *)

Definition property := nat.

(** A specifier as Algorithm 1 sees it; [name] is what it says. Two that agree in everything are equal here and different in Python,
    to the same effect: what both specify is specified twice, and if that is no error then neither is used. *)
Record specifier := Specifier {
  name : nat;
  specifies : list property;
  optional : list property;
  needs : list property
}.

(** A default value expression: what it says, and the properties of [self] that it reads. *)
Record expression := Expression { text : nat; reads : list property }.

(** A class: its own default value expressions, then those of its superclasses in the order of resolution up to Point (the lineage). *)
Definition class := list (list (property * expression)).

(** What can determine a property: a specifier that the source has, or the default of that property ([Specification] in Python). *)
Inductive specification :=
| Written (s : specifier)
| Default (p : property) (e : expression).

Definition dependencies (x : specification) : list property :=
  match x with Written s => needs s | Default _ e => reads e end.

Definition same (x y : specification) : {x = y} + {x <> y}.
Proof. repeat decide equality. Defined.

(** The four errors, each with what its message is about; the last with the specifications that are left. *)
Inductive error :=
| SpecifiedTwice (p : property) (first second : specification)
| SpecifiedTwiceOptionally (p : property) (candidates : list specification)
| MissingProperty (d : property) (x : specification)
| CyclicDependencies (waiting : list specification).

Inductive result (A : Type) :=
| Resolved (a : A)
| Failed (e : error).
Arguments Resolved {A}. Arguments Failed {A}.

Definition bind {A B : Type} (r : result A) (f : A -> result B) : result B :=
  match r with Resolved a => f a | Failed e => Failed e end.

(** A Python dictionary: its items in the order of insertion. *)
Definition dict (A : Type) := list (property * A).

Fixpoint lookup {A : Type} (p : property) (d : dict A) : option A :=
  match d with [] => None | (q, a) :: rest => if p =? q then Some a else lookup p rest end.

(** [d[p] = a]: a new key goes to the end, an old one keeps its place. *)
Fixpoint put {A : Type} (p : property) (a : A) (d : dict A) : dict A :=
  match d with [] => [(p, a)] | (q, b) :: rest => if p =? q then (q, a) :: rest else (q, b) :: put p a rest end.

(** [defaultValueExpressions(class)], [ScenicClass.defaults] in Python: the lineage from Point down to the class, where each class
    overrides what came before. *)
Definition default_value_expressions (c : class) : dict expression :=
  fold_left (fun d own => put (fst own) (snd own) d) (concat (rev c)) [].

(** * The algorithm *)

Section Algorithm.
  Variable c : class.
  Variable specifiers : list specifier.

  (** The properties that are specified non-optionally, and optionally, in the order of the two loops of phase 1. *)
  Definition non_optionally : list (property * specification) :=
    flat_map (fun s => map (fun p => (p, Written s)) (specifies s)) specifiers.
  Definition optionally : list (property * specification) :=
    flat_map (fun s => map (fun p => (p, Written s)) (optional s)) specifiers.

  (** [optionalSpecsForProperty(P)]. *)
  Definition optional_specs (p : property) : list specification :=
    map snd (filter (fun q => p =? fst q) optionally).

  (** Phase 1, "gather all specified properties". *)
  Fixpoint gather (d : dict specification) (specified : list (property * specification)) : result (dict specification) :=
    match specified with
    | [] => Resolved d
    | (p, x) :: rest =>
        match lookup p d with
        | Some first => Failed (SpecifiedTwice p first x)
        | None => gather (d ++ [(p, x)]) rest
        end
    end.

  (** Phase 2, "filter optional specifications". A name may come again; it then is in [d]. *)
  Fixpoint filter_optional (d : dict specification) (names : list property) : result (dict specification) :=
    match names with
    | [] => Resolved d
    | p :: rest =>
        match lookup p d with
        | Some _ => filter_optional d rest
        | None =>
            match optional_specs p with
            | [x] => filter_optional (d ++ [(p, x)]) rest
            | candidates => Failed (SpecifiedTwiceOptionally p candidates)
            end
        end
    end.

  (** Phase 3, "add default specifiers as needed". *)
  Fixpoint add_defaults (d : dict specification) (defaults : dict expression) : dict specification :=
    match defaults with
    | [] => d
    | (p, e) :: rest =>
        match lookup p d with
        | Some _ => add_defaults d rest
        | None => add_defaults (d ++ [(p, Default p e)]) rest
        end
    end.

  (** [specForProperty], after the first three phases. *)
  Definition spec_for_property : result (dict specification) :=
    bind (gather [] non_optionally) (fun d =>
    bind (filter_optional d (map fst optionally)) (fun d =>
    Resolved (add_defaults d (default_value_expressions c)))).

  (** Phase 4, "build dependency graph". Its vertices: the image of specForProperty, each once, as [dict.fromkeys] orders it. *)
  Fixpoint distinct (l : list specification) : list specification :=
    match l with [] => [] | x :: rest => x :: remove same x (distinct rest) end.
  Definition used (d : dict specification) : list specification := distinct (map snd d).

  (** Its edges: [specForProperty(D)] for the dependencies D of a vertex, and the first one that is missing. *)
  Definition edges_to (d : dict specification) (x : specification) : list specification :=
    flat_map (fun p => match lookup p d with Some y => [y] | None => [] end) (dependencies x).
  Definition first_missing (d : dict specification) : option (property * specification) :=
    find (fun q => match lookup (fst q) d with Some _ => false | None => true end)
      (flat_map (fun x => map (fun p => (p, x)) (dependencies x)) (used d)).

  (** "{ P | specForProperty (P) = S }". *)
  Definition properties_of (d : dict specification) (x : specification) : list property :=
    map fst (filter (fun q => if same (snd q) x then true else false) d).

  (** resolveSpecifiers: the phases above, then phase 5, "construct specifier and property evaluation order". *)
  Definition resolve : result (list (specification * list property)) :=
    bind spec_for_property (fun d =>
    match first_missing d with
    | Some (p, x) => Failed (MissingProperty p x)
    | None =>
        match topological_order _ same (edges_to d) (used d) with
        | inr waiting => Failed (CyclicDependencies waiting)
        | inl order => Resolved (map (fun x => (x, properties_of d x)) order)
        end
    end).

  (** * What the paper's text says of it *)

  (** The value expression of [p] in the most-derived class that has one. A class has one of each property; were there two, the last
      would count, as in a dictionary. *)
  Fixpoint most_derived (lineage : class) (p : property) : option expression :=
    match lineage with
    | [] => None
    | own :: superclasses =>
        match lookup p (rev own) with Some e => Some e | None => most_derived superclasses p end
    end.

  (** "The value of [p] will be determined by its unique non-optional specifier, unique optional specifier, or the most-derived default
      value, in that order". *)
  Inductive determines : specification -> property -> Prop :=
  | by_specifier s p : In s specifiers -> In p (specifies s) -> determines (Written s) p
  | by_optional_specifier s p :
      ~ In p (flat_map specifies specifiers) -> In s specifiers -> In p (optional s) -> determines (Written s) p
  | by_default p e :
      ~ In p (flat_map specifies specifiers) -> ~ In p (flat_map optional specifiers) ->
      most_derived c p = Some e -> determines (Default p e) p.

  (** Not "specified non-optionally by multiple specifiers", nor twice by one. *)
  Definition specified_once : Prop := NoDup (flat_map specifies specifiers).

  (** Not "only specified optionally, and by multiple specifiers", nor twice by one. *)
  Definition optionally_once : Prop :=
    forall p, ~ In p (flat_map specifies specifiers) -> count_occ Nat.eq_dec (flat_map optional specifiers) p <= 1.

  Definition dependencies_present : Prop :=
    forall x p d, determines x p -> In d (dependencies x) -> exists y, determines y d.

  (** The edges of the dependency graph, and that it has no cycle (a specifier that depends on what it determines is one). *)
  Definition precedes (y x : specification) : Prop :=
    (exists p, determines x p) /\ exists d, In d (dependencies x) /\ determines y d.
  Definition acyclic : Prop := forall x, ~ clos_trans _ precedes x x.

  (** Specifications with the properties that they are to determine, in an order that is admissible: each that determines something
      is there once, with all that it determines; its dependencies are determined by earlier ones. *)
  Record admissible (order : list (specification * list property)) : Prop := {
    each_once : NoDup (map fst order);
    all_there : forall x, In x (map fst order) <-> exists p, determines x p;
    their_properties : forall x ps, In (x, ps) order -> NoDup ps /\ forall p, In p ps <-> determines x p;
    dependencies_first : forall before x ps after d,
      order = before ++ (x, ps) :: after -> In d (dependencies x) -> exists y qs, In (y, qs) before /\ In d qs
  }.

  (** * Dictionaries *)

  Lemma lookup_app {A} p (d d' : dict A) :
    lookup p (d ++ d') = match lookup p d with Some a => Some a | None => lookup p d' end.
  Proof. induction d as [|[q a] d IH]; simpl; auto. destruct (p =? q); auto. Qed.

  Lemma lookup_none {A} p (d : dict A) : lookup p d = None <-> ~ In p (map fst d).
  Proof.
    induction d as [|[q a] d IH]; simpl; [tauto|]. destruct (Nat.eqb_spec p q).
    - split; [discriminate|]. intros H; exfalso; apply H; auto.
    - rewrite IH. split; intros H; [intros [->|I]; auto | auto].
  Qed.

  Lemma lookup_in {A} p (a : A) (d : dict A) : NoDup (map fst d) -> (lookup p d = Some a <-> In (p, a) d).
  Proof.
    induction d as [|[q b] d IH]; simpl; intros N; [split; [discriminate|easy]|]. inversion N; subst.
    destruct (Nat.eqb_spec p q) as [->|D].
    - split; [intros [= ->]; now left|]. intros [[= ->]|I]; auto.
      exfalso; apply H1. now apply (in_map fst) in I.
    - rewrite IH by auto. split; [now right|]. intros [[= -> ->]|I]; auto. congruence.
  Qed.

  Lemma keys_grow {A} p (a : A) (d : dict A) : lookup p d = None -> NoDup (map fst d) -> NoDup (map fst (d ++ [(p, a)])).
  Proof.
    intros L N. apply lookup_none in L. rewrite map_app. apply NoDup_Add with (a := p) (l := map fst d); auto.
    rewrite <- (app_nil_r (map fst d)) at 1. apply Add_app.
  Qed.

  Lemma lookup_put {A} p q (a : A) d : lookup q (put p a d) = if q =? p then Some a else lookup q d.
  Proof.
    induction d as [|[r b] d IH]; simpl; auto. destruct (Nat.eqb_spec p r) as [->|D]; simpl.
    - destruct (q =? r); auto.
    - rewrite IH. destruct (Nat.eqb_spec q r) as [->|E]; auto. destruct (Nat.eqb_spec r p); congruence.
  Qed.

  Lemma lookup_puts {A} q (l d : dict A) :
    lookup q (fold_left (fun d own => put (fst own) (snd own) d) l d) =
    match lookup q (rev l) with Some a => Some a | None => lookup q d end.
  Proof.
    revert d; induction l as [|[p a] l IH]; intros d; simpl; auto.
    rewrite IH, lookup_app, lookup_put. simpl. destruct (lookup q (rev l)); auto. destruct (q =? p); auto.
  Qed.

  Theorem the_default_is_that_of_the_most_derived_class p : lookup p (default_value_expressions c) = most_derived c p.
  Proof.
    unfold default_value_expressions. rewrite lookup_puts. simpl.
    assert (lookup p (rev (concat (rev c))) = most_derived c p) as ->; [|destruct (most_derived c p); auto].
    induction c as [|own superclasses IH]; simpl; auto.
    rewrite concat_app, rev_app_distr, lookup_app, IH. simpl. now rewrite app_nil_r.
  Qed.

  (** * The first three phases *)

  Lemma names_of (f : specifier -> list property) l :
    map fst (flat_map (fun s => map (fun p => (p, Written s)) (f s)) l) = flat_map f l.
  Proof.
    induction l as [|s l IH]; simpl; auto. rewrite map_app, IH, map_map. simpl. now rewrite map_id.
  Qed.

  Lemma gather_says specified : forall d, NoDup (map fst d) ->
    match gather d specified with
    | Resolved d' => d' = d ++ specified /\ NoDup (map fst (d ++ specified))
    | Failed (SpecifiedTwice _ _ _) => ~ NoDup (map fst (d ++ specified))
    | Failed _ => False
    end.
  Proof.
    induction specified as [|[p x] rest IH]; intros d N; simpl.
    - rewrite app_nil_r. auto.
    - destruct (lookup p d) as [first|] eqn:L.
      + rewrite map_app. simpl. intros N'. apply NoDup_remove_2 in N'. apply N'. apply in_or_app. left.
        destruct (in_dec Nat.eq_dec p (map fst d)) as [I|I]; auto. apply lookup_none in I. congruence.
      + specialize (IH (d ++ [(p, x)]) (keys_grow _ _ _ L N)). rewrite <- !app_assoc in IH. exact IH.
  Qed.

  Lemma filter_optional_says names : forall d, NoDup (map fst d) ->
    match filter_optional d names with
    | Resolved d' =>
        NoDup (map fst d') /\ (forall p, lookup p d = None -> In p names -> length (optional_specs p) = 1) /\
        forall p, lookup p d' = match lookup p d with
                                | Some x => Some x
                                | None => if in_dec Nat.eq_dec p names then hd_error (optional_specs p) else None
                                end
    | Failed (SpecifiedTwiceOptionally _ _) => exists p, lookup p d = None /\ In p names /\ length (optional_specs p) <> 1
    | Failed _ => False
    end.
  Proof.
    induction names as [|p names IH]; intros d N; cbn [filter_optional].
    - repeat split; auto; [easy|]. intros p. destruct (lookup p d); auto.
    - destruct (lookup p d) as [x|] eqn:L; [|destruct (optional_specs p) as [|x [|y l]] eqn:O].
      + specialize (IH d N). destruct (filter_optional d names) as [d'|[]]; auto.
        * destruct IH as (N' & One & Look). repeat split; auto.
          -- intros q Lq [->|I]; [congruence|auto].
          -- intros q. rewrite Look. destruct (lookup q d) eqn:Lq; auto. simpl.
             destruct (Nat.eq_dec p q) as [->|D]; [congruence|]. destruct (in_dec Nat.eq_dec q names); auto.
        * destruct IH as (q & Lq & I & NL). exists q. simpl. auto.
      + exists p. rewrite O. simpl. auto.
      + specialize (IH _ (keys_grow p x d L N)). destruct (filter_optional (d ++ [(p, x)]) names) as [d'|[]]; auto.
        * destruct IH as (N' & One & Look). repeat split; auto.
          -- intros q Lq I. destruct (Nat.eq_dec p q) as [->|D]; [now rewrite O|]. destruct I as [->|I]; [congruence|].
             apply One; auto. rewrite lookup_app, Lq. simpl. destruct (Nat.eqb_spec q p); congruence.
          -- intros q. rewrite Look, lookup_app. destruct (lookup q d) eqn:Lq; auto. simpl.
             destruct (Nat.eqb_spec q p) as [E|D]; destruct (Nat.eq_dec p q) as [E'|D']; try congruence.
             ++ subst q. now rewrite O.
             ++ destruct (in_dec Nat.eq_dec q names); auto.
        * destruct IH as (q & Lq & I & NL). exists q. rewrite lookup_app in Lq. simpl.
          destruct (lookup q d); [discriminate|]. auto.
      + exists p. rewrite O. simpl. auto.
  Qed.

  Lemma add_defaults_says defaults : forall d, NoDup (map fst d) ->
    NoDup (map fst (add_defaults d defaults)) /\
    forall p, lookup p (add_defaults d defaults) =
              match lookup p d with Some x => Some x | None => option_map (Default p) (lookup p defaults) end.
  Proof.
    induction defaults as [|[p e] rest IH]; intros d N; simpl.
    - split; auto. intros p. destruct (lookup p d); auto.
    - destruct (lookup p d) as [x|] eqn:L.
      + destruct (IH d N) as [N' Look]. split; auto. intros q. rewrite Look. destruct (lookup q d) eqn:Lq; auto.
        destruct (Nat.eqb_spec q p); auto. congruence.
      + destruct (IH _ (keys_grow p (Default p e) d L N)) as [N' Look]. split; auto. intros q. rewrite Look, lookup_app.
        destruct (lookup q d) eqn:Lq; auto. simpl. destruct (Nat.eqb_spec q p) as [->|]; auto.
  Qed.

  Lemma in_optional_specs p x :
    In x (optional_specs p) <-> exists s, x = Written s /\ In s specifiers /\ In p (optional s).
  Proof.
    unfold optional_specs, optionally. rewrite in_map_iff. split.
    - intros ([q y] & <- & H). apply filter_In in H as [H E]. apply Nat.eqb_eq in E. simpl in E; subst q.
      apply in_flat_map in H as (s & Hs & H). apply in_map_iff in H as (q & [= -> <-] & Hq). simpl. eauto.
    - intros (s & -> & Hs & Hp). exists (p, Written s). split; auto. apply filter_In. split; [|apply Nat.eqb_refl].
      apply in_flat_map. exists s. split; auto. apply in_map_iff. eauto.
  Qed.

  Lemma number_of_optional_specs p : length (optional_specs p) = count_occ Nat.eq_dec (flat_map optional specifiers) p.
  Proof.
    unfold optional_specs. rewrite map_length, <- names_of. unfold optionally.
    induction (flat_map _ _) as [|[q x] l IH]; simpl; auto.
    destruct (Nat.eqb_spec p q), (Nat.eq_dec q p); simpl; congruence.
  Qed.

  Lemma in_non_optionally p x :
    In (p, x) non_optionally <-> exists s, x = Written s /\ In s specifiers /\ In p (specifies s).
  Proof.
    unfold non_optionally. rewrite in_flat_map. split.
    - intros (s & Hs & H). apply in_map_iff in H as (q & [= -> <-] & Hq). eauto.
    - intros (s & -> & Hs & Hp). exists s. split; auto. apply in_map_iff. eauto.
  Qed.

  Lemma spec_for_property_says :
    match spec_for_property with
    | Resolved d =>
        specified_once /\ optionally_once /\ NoDup (map fst d) /\ forall p x, lookup p d = Some x <-> determines x p
    | Failed (SpecifiedTwice _ _ _) => ~ specified_once
    | Failed (SpecifiedTwiceOptionally _ _) => specified_once /\ ~ optionally_once
    | Failed _ => False
    end.
  Proof.
    unfold spec_for_property. pose proof (gather_says non_optionally [] (NoDup_nil _)) as G.
    assert (map fst non_optionally = flat_map specifies specifiers) as Names by apply names_of.
    destruct (gather [] non_optionally) as [d|[]]; cbn [bind]; try contradiction; simpl in G; rewrite Names in G; auto.
    destruct G as [-> Once].
    pose proof Once as N. rewrite <- Names in N.
    pose proof (filter_optional_says (map fst optionally) _ N) as F.
    unfold optionally at 1 in F. rewrite names_of in F.
    assert (map fst optionally = flat_map optional specifiers) as Optional by apply names_of.
    rewrite Optional in *.
    destruct (filter_optional non_optionally (flat_map optional specifiers)) as [d|[]]; cbn [bind]; try contradiction.
    - destruct F as (N1 & One & Look).
      destruct (add_defaults_says (default_value_expressions c) d N1) as (N2 & Look2).
      split; auto. split.
      { intros p Np. destruct (in_dec Nat.eq_dec p (flat_map optional specifiers)) as [I|I].
        - rewrite <- number_of_optional_specs, One; auto. apply lookup_none. now rewrite Names.
        - apply (count_occ_not_In Nat.eq_dec) in I. lia. }
      split; auto. intros p x. rewrite Look2, Look, the_default_is_that_of_the_most_derived_class.
      destruct (lookup p non_optionally) as [y|] eqn:L.
      + pose proof L as I. apply lookup_in in I; auto. pose proof I as Ip. apply (in_map fst) in Ip.
        rewrite Names in Ip. simpl in Ip. split.
        * intros [= <-]. apply in_non_optionally in I as (s & -> & Hs & Hp). now apply by_specifier.
        * intros D. destruct D as [s p Hs Hp|s p Np|p e Np]; try contradiction.
          rewrite <- L. apply lookup_in; auto. apply in_non_optionally. eauto.
      + apply lookup_none in L. rewrite Names in L.
        destruct (in_dec Nat.eq_dec p (flat_map optional specifiers)) as [I|I].
        * assert (lookup p non_optionally = None) as L' by (apply lookup_none; now rewrite Names).
          specialize (One p L' I). destruct (optional_specs p) as [|y [|]] eqn:O; try discriminate. simpl. split.
          -- intros [= <-]. assert (In y (optional_specs p)) as Iy by (rewrite O; now left).
             apply in_optional_specs in Iy as (s & -> & Hs & Hp). now apply by_optional_specifier.
          -- intros D. destruct D as [s p Hs Hp|s p Np Hs Hp|p e Np No]; try contradiction.
             ++ exfalso. apply L. apply in_flat_map; eauto.
             ++ assert (In (Written s) (optional_specs p)) as Iy by (apply in_optional_specs; eauto).
                rewrite O in Iy. destruct Iy as [->|[]]; auto.
        * destruct (most_derived c p) as [e|] eqn:M; simpl; split.
          -- intros [= <-]. now apply by_default.
          -- intros D. destruct D as [s p Hs Hp|s p Np Hs Hp|p e' Np No]; try congruence.
             ++ exfalso. apply L. apply in_flat_map; eauto.
             ++ exfalso. apply I. apply in_flat_map; eauto.
          -- discriminate.
          -- intros D. destruct D as [s p Hs Hp|s p Np Hs Hp|p e' Np No]; try congruence.
             ++ exfalso. apply L. apply in_flat_map; eauto.
             ++ exfalso. apply I. apply in_flat_map; eauto.
    - split; auto. destruct F as (q & L & I & NL). intros O. apply NL. apply lookup_none in L. rewrite Names in L.
      specialize (O q L). rewrite number_of_optional_specs. apply (count_occ_In Nat.eq_dec) in I. lia.
  Qed.

  (** * The graph *)

  Lemma in_distinct x l : In x (distinct l) <-> In x l.
  Proof.
    induction l as [|y l IH]; simpl; [tauto|]. destruct (same y x) as [->|D]; [tauto|].
    split; intros [E|I]; auto; right.
    - apply in_remove in I. tauto.
    - apply in_in_remove; auto. tauto.
  Qed.

  Lemma NoDup_distinct l : NoDup (distinct l).
  Proof.
    induction l as [|y l IH]; simpl; constructor; [apply remove_In|].
    clear - IH. induction IH as [|x k NI N IH]; simpl; [constructor|].
    destruct (same y x); auto. constructor; auto. intros I. apply in_remove in I. tauto.
  Qed.

  Lemma NoDup_properties_of d x : NoDup (map fst d) -> NoDup (properties_of d x).
  Proof.
    unfold properties_of. induction d as [|[p y] d IH]; simpl; intros N; [constructor|]. inversion N; subst.
    destruct (same y x); simpl; auto. constructor; auto. intros I. apply H1.
    apply in_map_iff in I as (q & <- & I). apply filter_In in I as [I _]. now apply in_map.
  Qed.

  Section Graph.
    Variable d : dict specification.
    Hypothesis keys : NoDup (map fst d).
    Hypothesis says : forall p x, lookup p d = Some x <-> determines x p.

    Lemma in_used x : In x (used d) <-> exists p, determines x p.
    Proof.
      unfold used. rewrite in_distinct, in_map_iff. split.
      - intros ([p y] & <- & I). exists p. now apply says, lookup_in.
      - intros (p & D). exists (p, x). split; auto. now apply lookup_in, says.
    Qed.

    Lemma in_edges_to x y : In y (edges_to d x) <-> exists p, In p (dependencies x) /\ determines y p.
    Proof.
      unfold edges_to. rewrite in_flat_map. split; intros (p & Hp & H); exists p; split; auto.
      - destruct (lookup p d) as [z|] eqn:L; [|easy]. destruct H as [<-|[]]. now apply says.
      - apply says in H. rewrite H. now left.
    Qed.

    Lemma in_properties_of x p : In p (properties_of d x) <-> determines x p.
    Proof.
      unfold properties_of. rewrite in_map_iff, <- says, lookup_in by auto. split.
      - intros ([q y] & <- & I). apply filter_In in I as [I E]. simpl in *. destruct (same y x); [now subst|discriminate].
      - intros I. exists (p, x). split; auto. apply filter_In. split; auto. simpl. destruct (same x x); congruence.
    Qed.

    Lemma nothing_missing : first_missing d = None <-> dependencies_present.
    Proof.
      unfold first_missing, dependencies_present. split.
      - intros F x p q D I.
        assert (In (q, x) (flat_map (fun x => map (fun p => (p, x)) (dependencies x)) (used d))) as Iq.
        { apply in_flat_map. exists x. split; [apply in_used; eauto|]. apply in_map_iff; eauto. }
        pose proof (find_none _ _ F _ Iq) as L. simpl in L. destruct (lookup q d) as [y|] eqn:Lq; [|discriminate].
        exists y. now apply says.
      - intros P. destruct (find _ _) as [[q x]|] eqn:F; auto. exfalso.
        apply find_some in F as [I L]. simpl in L. apply in_flat_map in I as (y & Iy & I).
        apply in_map_iff in I as (r & [= -> ->] & I). apply in_used in Iy as (p & D).
        destruct (P x p q D I) as (z & Dz). apply says in Dz. rewrite Dz in L. discriminate.
    Qed.
  End Graph.

  (** Everything about [resolve] at once, phase by phase. *)
  Lemma resolve_says :
    match resolve with
    | Resolved order => specified_once /\ optionally_once /\ dependencies_present /\ acyclic /\ admissible order
    | Failed (SpecifiedTwice _ _ _) => ~ specified_once
    | Failed (SpecifiedTwiceOptionally _ _) => specified_once /\ ~ optionally_once
    | Failed (MissingProperty _ _) => specified_once /\ optionally_once /\ ~ dependencies_present
    | Failed (CyclicDependencies _) => specified_once /\ optionally_once /\ dependencies_present /\ ~ acyclic
    end.
  Proof.
    unfold resolve. pose proof spec_for_property_says as S.
    destruct spec_for_property as [d|[]]; cbn [bind]; try easy.
    destruct S as (Once & Opt & N & Says). pose proof (nothing_missing d N Says) as M.
    destruct (first_missing d) as [[p x]|] eqn:F.
    - split; auto. split; auto. rewrite <- M. discriminate.
    - assert (dependencies_present) as P by now apply M.
      assert (forall x, In x (used d) -> incl (edges_to d x) (used d)) as Closed.
      { intros x Hx y Hy. apply (in_edges_to d) in Hy as (q & _ & D); auto. apply in_used; eauto. }
      destruct (topological_order specification same (edges_to d) (used d)) as [order|waiting] eqn:T.
      + apply the_order_found_is_topological in T as [Q T].
        assert (forall x, In x order <-> exists p, determines x p) as There.
        { intros x. rewrite <- (in_used d N Says). split; apply Permutation_in; auto. now symmetry. }
        split; auto. split; auto. split; auto. split.
        { intros x. apply (what_has_a_topological_order_has_no_cycle _ (edges_to d) order); auto.
          intros u v [Dv I]. split; [now apply There | now apply in_edges_to]. }
        assert (map fst (map (fun x => (x, properties_of d x)) order) = order) as First
          by (rewrite map_map; simpl; apply map_id).
        constructor.
        * rewrite First. eapply Permutation_NoDup; [exact Q|]. apply NoDup_distinct.
        * intros x. now rewrite First.
        * intros x ps I. apply in_map_iff in I as (y & [= -> <-] & I). split.
          -- now apply NoDup_properties_of.
          -- intros p. now apply in_properties_of.
        * clear First Q. intros before x ps after q E I.
          assert (exists p, determines x p) as (p & Dp).
          { apply There. assert (In (x, ps) (map (fun x => (x, properties_of d x)) order)) as Ix
              by (rewrite E; apply in_or_app; right; now left).
            apply in_map_iff in Ix as (z & [= -> _] & Iz). exact Iz. }
          destruct (P x p q Dp I) as (y & Dy).
          assert (In y (edges_to d x)) as Ey by (apply in_edges_to; eauto).
          assert (forall placed, topological _ (edges_to d) placed order -> forall before,
                    map (fun x => (x, properties_of d x)) order = before ++ (x, ps) :: after ->
                    In y placed \/ In (y, properties_of d y) before) as Earlier.
          { clear - Ey. intros placed T. induction T as [|placed z order Inc T IH]; intros before E.
            - destruct before; discriminate.
            - destruct before as [|b before]; simpl in E; inversion E; subst.
              + left. now apply Inc.
              + destruct (IH _ H1) as [[<-|]|]; auto; right; [now left | now right]. }
          destruct (Earlier [] T _ E) as [[]|Iy].
          exists y, (properties_of d y). split; auto. now apply in_properties_of.
      + split; auto. split; auto. split; auto. intros A.
        apply no_order_is_found_only_if_there_is_a_cycle with (precedes := precedes) in T as (x & C); auto.
        * exact (A x C).
        * intros x y Hx Hy. split; [now apply (in_used d) | now apply (in_edges_to d)].
  Qed.

  Lemma what_determines_a_property_is_unique x y p :
    specified_once -> optionally_once -> determines x p -> determines y p -> x = y.
  Proof.
    intros Once Opt X Y. pose proof spec_for_property_says as S.
    destruct spec_for_property as [d|[]]; try tauto. destruct S as (_ & _ & _ & Says).
    apply Says in X, Y. congruence.
  Qed.

  (** * When it succeeds *)

  Theorem resolution_succeeds_exactly_when_no_property_is_specified_twice_and_dependencies_are_present_and_acyclic :
    (exists order, resolve = Resolved order) <-> specified_once /\ optionally_once /\ dependencies_present /\ acyclic.
  Proof.
    pose proof resolve_says as R. destruct resolve as [order|[]]; split; try tauto; try (intros (? & [=])).
    intros _. eauto.
  Qed.

  Theorem the_error_is_that_of_the_first_phase_that_finds_one :
    ((exists p x y, resolve = Failed (SpecifiedTwice p x y)) <-> ~ specified_once) /\
    ((exists p xs, resolve = Failed (SpecifiedTwiceOptionally p xs)) <-> specified_once /\ ~ optionally_once) /\
    ((exists p x, resolve = Failed (MissingProperty p x)) <->
      specified_once /\ optionally_once /\ ~ dependencies_present) /\
    ((exists xs, resolve = Failed (CyclicDependencies xs)) <->
      specified_once /\ optionally_once /\ dependencies_present /\ ~ acyclic).
  Proof.
    pose proof resolve_says as R.
    destruct resolve as [order|[]]; repeat match goal with |- _ /\ _ => split | |- _ <-> _ => split end; try tauto;
      try (intros (? & ? & ? & [=])); try (intros (? & ? & [=])); try (intros (? & [=])); intros _; eauto.
  Qed.

  (** * What an error is about *)

  Lemma gather_fails_of specified : forall d p x y, NoDup (map fst d) -> gather d specified = Failed (SpecifiedTwice p x y) ->
    exists before between after,
      d ++ specified = before ++ (p, x) :: between ++ (p, y) :: after /\ NoDup (map fst (before ++ (p, x) :: between)).
  Proof.
    induction specified as [|[q z] rest IH]; intros d p x y N; simpl; [discriminate|].
    destruct (lookup q d) as [first|] eqn:L.
    - intros [= -> -> ->]. apply lookup_in in L; auto. apply in_split in L as (before & between & ->).
      exists before, between, rest. rewrite <- app_assoc. now split.
    - intros G. destruct (IH _ _ _ _ (keys_grow _ _ _ L N) G) as (before & between & after & E & M).
      exists before, between, after. rewrite <- app_assoc in E. now split.
  Qed.

  Lemma filter_optional_fails_of names : forall d p xs, filter_optional d names = Failed (SpecifiedTwiceOptionally p xs) ->
    exists before after, names = before ++ p :: after /\ lookup p d = None /\ xs = optional_specs p /\ length xs <> 1 /\
      forall q, In q before -> lookup q d <> None \/ length (optional_specs q) = 1.
  Proof.
    induction names as [|q names IH]; intros d p xs; cbn [filter_optional]; [discriminate|].
    destruct (lookup q d) as [first|] eqn:L.
    - intros F. destruct (IH d p xs F) as (before & after & -> & Lp & X & NL & B). exists (q :: before), after.
      repeat split; auto. intros r [<-|I]; auto. left. congruence.
    - destruct (optional_specs q) as [|x [|y l]] eqn:O.
      + intros [= <- <-]. exists [], names. rewrite O. repeat split; auto; easy.
      + intros F. destruct (IH _ p xs F) as (before & after & -> & Lp & X & NL & B). rewrite lookup_app in Lp.
        exists (q :: before), after. repeat split; auto.
        * destruct (lookup p d); [discriminate|reflexivity].
        * intros r [<-|I]; [right; now rewrite O|]. destruct (B r I) as [Lr|One]; auto. rewrite lookup_app in Lr.
          destruct (lookup r d); [now left|]. simpl in Lr. destruct (Nat.eqb_spec r q) as [->|]; [|congruence]. right. now rewrite O.
      + intros [= <- <-]. exists [], names. rewrite O. repeat split; auto; easy.
  Qed.

  (** The phase that an error comes from. *)
  Lemma where_the_error_comes_from e : resolve = Failed e ->
    match e with
    | SpecifiedTwice _ _ _ => gather [] non_optionally = Failed e
    | SpecifiedTwiceOptionally _ _ => filter_optional non_optionally (map fst optionally) = Failed e
    | MissingProperty p x => exists d, spec_for_property = Resolved d /\ first_missing d = Some (p, x)
    | CyclicDependencies waiting => exists d, spec_for_property = Resolved d /\ first_missing d = None /\
        topological_order _ same (edges_to d) (used d) = inr waiting
    end.
  Proof.
    pose proof spec_for_property_says as S. unfold resolve. destruct spec_for_property as [d|e'] eqn:E; cbn [bind].
    - destruct (first_missing d) as [[p x]|] eqn:M; [intros [= <-]; eauto|].
      destruct (topological_order _ same (edges_to d) (used d)) eqn:T; [discriminate|]. intros [= <-]. eauto.
    - intros [= ->]. unfold spec_for_property in E. pose proof (gather_says non_optionally [] (NoDup_nil _)) as G.
      destruct (gather [] non_optionally) as [d|[]]; cbn [bind] in E; try contradiction; [|now injection E as <-].
      destruct G as [-> N]. cbn [app] in *. pose proof (filter_optional_says (map fst optionally) _ N) as F.
      destruct (filter_optional non_optionally (map fst optionally)) as [d|[]]; cbn [bind] in E; try contradiction; [discriminate|].
      now injection E as <-.
  Qed.

  (** All that comes before the second of the two is specified once, and so it is the first property that is specified again. *)
  Theorem the_property_specified_twice_is_the_first_that_is_and_its_specifiers_are_named_in_the_order_of_the_source p x y :
    resolve = Failed (SpecifiedTwice p x y) ->
    exists before between after,
      non_optionally = before ++ (p, x) :: between ++ (p, y) :: after /\ NoDup (map fst (before ++ (p, x) :: between)).
  Proof. intros E. apply where_the_error_comes_from in E. now apply (gather_fails_of non_optionally []); [constructor|]. Qed.

  Theorem the_property_specified_twice_optionally_is_the_first_that_is_and_all_its_specifiers_are_named p xs :
    resolve = Failed (SpecifiedTwiceOptionally p xs) ->
    xs = optional_specs p /\ 2 <= length xs /\ ~ In p (flat_map specifies specifiers) /\
    exists before after, flat_map optional specifiers = before ++ p :: after /\
      forall q, In q before -> In q (flat_map specifies specifiers) \/ count_occ Nat.eq_dec (flat_map optional specifiers) q = 1.
  Proof.
    intros E. apply where_the_error_comes_from, filter_optional_fails_of in E as (before & after & E & L & -> & NL & B).
    assert (map fst non_optionally = flat_map specifies specifiers) as Names by apply names_of.
    assert (map fst optionally = flat_map optional specifiers) as Optional by apply names_of.
    rewrite Optional in E. rewrite lookup_none, Names in L. split; [reflexivity|]. split; [|split; [exact L|]].
    - rewrite number_of_optional_specs in *. assert (In p (flat_map optional specifiers)) as I by (rewrite E; apply in_elt).
      apply (count_occ_In Nat.eq_dec) in I. lia.
    - exists before, after. split; [exact E|]. intros q I. destruct (B q I) as [Lq|One].
      + left. destruct (in_dec Nat.eq_dec q (flat_map specifies specifiers)) as [S|S]; [exact S|].
        destruct Lq. apply lookup_none. now rewrite Names.
      + right. now rewrite <- number_of_optional_specs.
  Qed.

  Theorem the_missing_property_is_one_that_nothing_determines_and_what_depends_on_it_is_named d x :
    resolve = Failed (MissingProperty d x) ->
    In d (dependencies x) /\ (exists p, determines x p) /\ ~ exists y, determines y d.
  Proof.
    intros E. apply where_the_error_comes_from in E as (found & E & F).
    pose proof spec_for_property_says as S. rewrite E in S. destruct S as (_ & _ & N & Says).
    apply find_some in F as [I L]. apply in_flat_map in I as (y & Iy & I). apply in_map_iff in I as (r & [= -> ->] & I).
    split; [exact I|]. split; [now apply (in_used found)|]. intros (y & D). apply Says in D. simpl in L. now rewrite D in L.
  Qed.

  Theorem what_waits_depends_on_what_waits_and_nothing_else_hangs_on_a_cycle waiting :
    resolve = Failed (CyclicDependencies waiting) ->
    waiting <> [] /\ (forall x, In x waiting -> exists y, In y waiting /\ precedes y x) /\
    forall x p, determines x p -> ~ In x waiting -> Acc precedes x.
  Proof.
    intros E. apply where_the_error_comes_from in E as (d & E & _ & T).
    pose proof spec_for_property_says as S. rewrite E in S. destruct S as (_ & _ & N & Says).
    apply what_is_left_depends_on_what_is_left_and_nothing_else_hangs_on_a_cycle with (precedes := precedes) in T as (NE & _ & D & A).
    - split; [exact NE|]. split; [exact D|]. intros x p Dx. apply A, (in_used d N Says). eauto.
    - intros x _ y Hy. apply (in_edges_to d Says) in Hy as (q & _ & D). apply (in_used d N Says). eauto.
    - intros x y Hx. rewrite (in_edges_to d Says). apply (in_used d N Says) in Hx. unfold precedes. tauto.
  Qed.

  (** The text that explains Algorithm 1 has another graph, "with vertices P and edges to p from each of the dependencies of s_p". *)
  Definition property_precedes (q p : property) : Prop := exists x, determines x p /\ In q (dependencies x) /\ exists y, determines y q.

  Theorem the_graph_of_properties_is_acyclic_exactly_when_that_of_specifiers_is :
    (forall p, ~ clos_trans _ property_precedes p p) <-> acyclic.
  Proof.
    split.
    - intros N x C.
      assert (forall y x, clos_trans _ precedes y x ->
                exists q, determines y q /\ forall p, determines x p -> clos_trans _ property_precedes q p) as Through.
      { clear. intros y x C. induction C as [y x [_ (d & I & D)]|y z x _ (q & Dq & Q) _ (r & Dr & R)].
        - exists d. split; auto. intros p Dp. apply t_step. exists x. eauto.
        - exists q. split; auto. intros p Dp. eapply t_trans; eauto. }
      destruct (Through x x C) as (q & D & Q). exact (N q (Q q D)).
    - intros N p C.
      assert (forall q p, clos_trans _ property_precedes q p ->
                exists x, determines x p /\ forall y, determines y q -> clos_trans _ precedes y x) as Through.
      { clear. intros q p C. induction C as [q p (x & D & I & _)|q r p _ (z & Dz & Z) _ (x & Dx & X)].
        - exists x. split; auto. intros y Dy. apply t_step. split; eauto.
        - exists x. split; auto. intros y Dy. eapply t_trans; eauto. }
      destruct (Through p p C) as (x & D & X). exact (N x (X x D)).
  Qed.

  (** * Which specifier determines a property *)

  Theorem each_property_is_determined_by_its_non_optional_specifier_else_its_optional_one_else_its_default order : resolve = Resolved order ->
    forall x p, (exists ps, In (x, ps) order /\ In p ps) <-> determines x p.
  Proof.
    intros E x p. pose proof resolve_says as R. rewrite E in R. destruct R as (_ & _ & _ & _ & A). split.
    - intros (ps & I & Ip). now apply (their_properties _ A x ps).
    - intros D. assert (In x (map fst order)) as I by (apply (all_there _ A); eauto).
      apply in_map_iff in I as ([y ps] & <- & I). exists ps. split; auto. now apply (their_properties _ A y ps).
  Qed.

  Lemma apart {A} (p : A) l r : NoDup (l ++ r) -> In p l -> ~ In p r.
  Proof.
    induction l as [|a l IH]; simpl; [easy|]. intros N [->|I]; inversion N; subst; auto.
    intros Ir. apply H1, in_or_app. now right.
  Qed.

  Lemma an_admissible_order_determines_once order : specified_once -> optionally_once -> admissible order ->
    NoDup (flat_map snd order).
  Proof.
    intros Once Opt A. pose proof (each_once _ A) as N. pose proof (their_properties _ A) as Their. clear A.
    induction order as [|[x ps] order IH]; simpl; [constructor|]. simpl in N. inversion N; subst.
    assert (NoDup (flat_map snd order)) as Rest by (apply IH; auto; intros y qs I; apply Their; now right).
    destruct (Their x ps (or_introl eq_refl)) as [Nps Ps].
    assert (forall p, In p ps -> ~ In p (flat_map snd order)) as Apart.
    { intros p Ip I. apply in_flat_map in I as ([y qs] & Iy & Iq). simpl in Iq. apply H1.
      assert (determines y p) as Dy by now apply (Their y qs (or_intror Iy)).
      rewrite (what_determines_a_property_is_unique x y p); auto; [now apply (in_map fst) in Iy | now apply Ps]. }
    clear - Rest Apart Nps. induction Nps as [|p ps NI Nps IH]; simpl; auto. constructor.
    - rewrite in_app_iff. intros [I|I]; auto. apply (Apart p); auto. now left.
    - apply IH. intros q Iq. apply Apart. now right.
  Qed.

  Theorem each_property_is_determined_exactly_once order : resolve = Resolved order ->
    NoDup (flat_map snd order) /\ NoDup (map fst order) /\
    forall p, In p (flat_map snd order) -> exists! x, exists ps, In (x, ps) order /\ In p ps.
  Proof.
    intros E. pose proof (each_property_is_determined_by_its_non_optional_specifier_else_its_optional_one_else_its_default order E) as Pre.
    pose proof resolve_says as R. rewrite E in R. destruct R as (Once & Opt & _ & _ & A).
    split; [now apply an_admissible_order_determines_once|]. split; [exact (each_once _ A)|].
    intros p I. apply in_flat_map in I as ([x ps] & Ix & Ip). exists x. split; eauto.
    intros y H. apply (what_determines_a_property_is_unique x y p); auto; apply Pre; eauto.
  Qed.

  Theorem the_object_has_the_properties_that_are_specified_or_have_a_default order : resolve = Resolved order ->
    forall p, In p (flat_map snd order) <->
              In p (flat_map specifies specifiers) \/ In p (flat_map optional specifiers) \/ most_derived c p <> None.
  Proof.
    intros E p. pose proof (each_property_is_determined_by_its_non_optional_specifier_else_its_optional_one_else_its_default order E) as Pre.
    assert (In p (flat_map snd order) <-> exists x, determines x p) as ->.
    { rewrite in_flat_map. split.
      - intros ([x ps] & I & Ip). exists x. apply Pre. eauto.
      - intros (x & D). apply Pre in D as (ps & I & Ip). exists (x, ps). auto. }
    split.
    - intros (x & D). destruct D as [s p Hs Hp|s p Np Hs Hp|p e Np No M].
      + left. apply in_flat_map; eauto.
      + right; left. apply in_flat_map; eauto.
      + right; right. congruence.
    - intros H.
      destruct (in_dec Nat.eq_dec p (flat_map specifies specifiers)) as [S|S].
      { apply in_flat_map in S as (s & Hs & Hp). exists (Written s). now apply by_specifier. }
      destruct (in_dec Nat.eq_dec p (flat_map optional specifiers)) as [O|O].
      { apply in_flat_map in O as (s & Hs & Hp). exists (Written s). now apply by_optional_specifier. }
      destruct (most_derived c p) as [e|] eqn:M; [|tauto]. exists (Default p e). now apply by_default.
  Qed.

  (** * In which order *)

  Theorem the_order_returned_is_admissible order : resolve = Resolved order -> admissible order.
  Proof. intros E. pose proof resolve_says as R. rewrite E in R. tauto. Qed.

  Theorem every_dependency_is_determined_before_its_dependents order : resolve = Resolved order ->
    forall before x ps after d, order = before ++ (x, ps) :: after -> In d (dependencies x) ->
    exists y qs, In (y, qs) before /\ In d qs.
  Proof. intros E. exact (dependencies_first _ (the_order_returned_is_admissible order E)). Qed.
End Algorithm.

(** * The object that is built *)

Section Object.
  Variable value : Type.

  (** The value that a specification gives to a property, from those of its dependencies only. Where it draws at random, this stands
      for any one outcome of its draws. *)
  Variable evaluate : specification -> list (option value) -> property -> value.

  Definition object := property -> option value.

  (** "sigma_i [self.p_i / v_i(p_i)]" of the rule "Object Definitions", and its whole sequence, that begins with "self / bottom". *)
  Definition assign (self : object) (xps : specification * list property) : object :=
    let (x, ps) := xps in
    fun p => if in_dec Nat.eq_dec p ps then Some (evaluate x (map self (dependencies x)) p) else self p.
  Definition build (order : list (specification * list property)) : object := fold_left assign order (fun _ => None).

  Lemma assign_elsewhere order : forall self p, ~ In p (flat_map snd order) -> fold_left assign order self p = self p.
  Proof.
    induction order as [|[x ps] order IH]; intros self p N; simpl in *; auto. rewrite in_app_iff in N.
    rewrite IH by tauto. simpl. destruct (in_dec Nat.eq_dec p ps); tauto.
  Qed.

  Lemma values_are_final c specifiers order : specified_once specifiers -> optionally_once specifiers ->
    admissible c specifiers order -> forall x p, determines c specifiers x p ->
    build order p = Some (evaluate x (map (build order) (dependencies x)) p).
  Proof.
    intros Once Opt A x p D.
    assert (In x (map fst order)) as I by (apply (all_there _ _ _ A); eauto).
    apply in_map_iff in I as ([y ps] & E & I). simpl in E; subst y.
    apply in_split in I as (before & after & E).
    assert (In p ps) as Ip.
    { apply (their_properties _ _ _ A x ps); auto. rewrite E. apply in_or_app; right; now left. }
    pose proof (an_admissible_order_determines_once _ _ _ Once Opt A) as N.
    rewrite E, flat_map_app in N. simpl in N.
    assert (~ In p (flat_map snd after)) as Later.
    { rewrite app_assoc in N. apply (apart p _ _ N), in_or_app. now right. }
    unfold build. rewrite E, fold_left_app. cbn [fold_left].
    rewrite assign_elsewhere by exact Later. cbn [assign].
    destruct (in_dec Nat.eq_dec p ps) as [_|]; [|contradiction]. do 2 f_equal. apply map_ext_in. intros d Id.
    destruct (dependencies_first _ _ _ A before x ps after d E Id) as (y & qs & Iy & Iq).
    assert (~ In d (ps ++ flat_map snd after)) as Nd.
    { apply (apart d _ _ N), in_flat_map. exists (y, qs). auto. }
    rewrite in_app_iff in Nd. rewrite (assign_elsewhere after) by tauto. cbn [assign].
    destruct (in_dec Nat.eq_dec d ps); tauto.
  Qed.

  Theorem each_value_is_computed_from_the_values_that_the_finished_object_has c specifiers order :
    resolve c specifiers = Resolved order -> forall x p, determines c specifiers x p ->
    build order p = Some (evaluate x (map (build order) (dependencies x)) p).
  Proof.
    intros E. pose proof (resolve_says c specifiers) as R. rewrite E in R. apply values_are_final; tauto.
  Qed.

  Lemma admissible_orders_agree c specifiers one another : specified_once specifiers -> optionally_once specifiers ->
    admissible c specifiers one -> admissible c specifiers another -> forall p, build one p = build another p.
  Proof.
    intros Once Opt A1 A2.
    pose proof (values_are_final c specifiers one Once Opt A1) as F1.
    pose proof (values_are_final c specifiers another Once Opt A2) as F2.
    assert (forall before after, one = before ++ after ->
              forall x ps p, In (x, ps) before -> In p ps -> build one p = build another p) as Agree.
    { intros before. induction before as [|[y qs] before IH] using rev_ind; intros after E x ps p I Ip; [easy|].
      rewrite <- app_assoc in E. simpl in E.
      apply in_app_iff in I as [I|[[= -> ->]|[]]]; [now apply (IH _ E x ps)|].
      assert (determines c specifiers x p) as D.
      { apply (their_properties _ _ _ A1 x ps); auto. rewrite E. apply in_or_app; right; now left. }
      rewrite (F1 x p D), (F2 x p D). do 2 f_equal. apply map_ext_in. intros d Id.
      destruct (dependencies_first _ _ _ A1 before x ps after d E Id) as (z & rs & Iz & Ir).
      now apply (IH _ E z rs). }
    intros p. destruct (in_dec Nat.eq_dec p (flat_map snd one)) as [I|I].
    - apply in_flat_map in I as ([x ps] & I & Ip). apply (Agree one [] (eq_sym (app_nil_r one)) x ps); auto.
    - unfold build. rewrite !assign_elsewhere; auto. intros I2. apply I.
      apply in_flat_map in I2 as ([x ps] & I2 & Ip). simpl in Ip.
      assert (determines c specifiers x p) as D by now apply (their_properties _ _ _ A2 x ps).
      assert (In x (map fst one)) as Ix by (apply (all_there _ _ _ A1); eauto).
      apply in_map_iff in Ix as ([y qs] & E & Ix). simpl in E; subst y.
      apply in_flat_map. exists (x, qs). split; auto. now apply (their_properties _ _ _ A1 x qs).
  Qed.

  Theorem any_two_topological_orders_build_the_same_object c specifiers order : resolve c specifiers = Resolved order ->
    forall one another, admissible c specifiers one -> admissible c specifiers another ->
    forall p, build one p = build another p.
  Proof.
    intros E one another. pose proof (resolve_says c specifiers) as R. rewrite E in R. apply admissible_orders_agree; tauto.
  Qed.
End Object.

(** * The order of the source *)

Definition same_kind (e e' : error) : Prop :=
  match e, e' with
  | SpecifiedTwice _ _ _, SpecifiedTwice _ _ _
  | SpecifiedTwiceOptionally _ _, SpecifiedTwiceOptionally _ _
  | MissingProperty _ _, MissingProperty _ _
  | CyclicDependencies _, CyclicDependencies _ => True
  | _, _ => False
  end.

Lemma in_flat_map_permuted (f : specifier -> list property) s s' p :
  Permutation s s' -> In p (flat_map f s) -> In p (flat_map f s').
Proof. intros P. apply Permutation_in. now apply Permutation_flat_map. Qed.

Lemma determines_permuted c s s' x p : Permutation s s' -> determines c s x p -> determines c s' x p.
Proof.
  intros P D. pose proof (in_flat_map_permuted) as F. pose proof (Permutation_sym P) as P'.
  destruct D as [s0 p Hs Hp|s0 p Np Hs Hp|p e Np No M].
  - apply by_specifier; auto. now apply (Permutation_in _ P).
  - apply by_optional_specifier; eauto. now apply (Permutation_in _ P).
  - apply by_default; eauto.
Qed.

Lemma conditions_permuted c s s' : Permutation s s' ->
  (specified_once s -> specified_once s') /\ (optionally_once s -> optionally_once s') /\
  (dependencies_present c s -> dependencies_present c s') /\ (acyclic c s -> acyclic c s') /\
  forall order, admissible c s order -> admissible c s' order.
Proof.
  intros P. pose proof (Permutation_sym P) as P'.
  assert (forall x p, determines c s x p <-> determines c s' x p) as D by (split; now apply determines_permuted).
  repeat split.
  - unfold specified_once. apply Permutation_NoDup. now apply Permutation_flat_map.
  - intros O p Np. assert (Permutation (flat_map optional s) (flat_map optional s')) as Po by now apply Permutation_flat_map.
    rewrite <- ((proj1 (Permutation_count_occ Nat.eq_dec _ _)) Po p). apply O.
    intros I. apply Np. now apply (in_flat_map_permuted specifies s s').
  - intros Q x p d Dx I. apply D in Dx. destruct (Q x p d Dx I) as (y & Dy). exists y. now apply D.
  - intros A x C. apply (A x). clear - C D. revert C. generalize x at 1 3. intros y C.
    induction C as [u v [(p & Du) (d & I & Dv)]|u v w]; [|eapply t_trans; eauto].
    apply t_step. split; [exists p | exists d; split; auto]; now apply D.
  - apply (each_once _ _ _ H).
  - intros I. apply (all_there _ _ _ H) in I as (p & I). exists p. now apply D.
  - intros (p & I). apply (all_there _ _ _ H). exists p. now apply D.
  - now apply (their_properties _ _ _ H x ps).
  - intros I. apply D. now apply (their_properties _ _ _ H x ps).
  - intros I. apply D in I. now apply (their_properties _ _ _ H x ps).
  - intros before x ps after d. apply (dependencies_first _ _ _ H).
Qed.

(** A permutation of the specifiers changes neither success, nor which specification determines a property, nor the object that is
    built; nor the class of the error. It may change the order of evaluation, and what the error is about: see the example. *)
Theorem the_order_of_specifiers_in_the_source_is_irrelevant c s s' : Permutation s s' ->
  match resolve c s, resolve c s' with
  | Resolved order, Resolved order' =>
      (forall x p, (exists ps, In (x, ps) order /\ In p ps) <-> (exists ps, In (x, ps) order' /\ In p ps)) /\
      forall value (evaluate : specification -> list (option value) -> property -> value) p,
        build value evaluate order p = build value evaluate order' p
  | Failed e, Failed e' => same_kind e e'
  | _, _ => False
  end.
Proof.
  intros P. destruct (conditions_permuted c s s' P) as (F1 & F2 & F3 & F4 & F5).
  destruct (conditions_permuted c s' s (Permutation_sym P)) as (G1 & G2 & G3 & G4 & G5).
  pose proof (resolve_says c s) as R. pose proof (resolve_says c s') as R'.
  destruct (resolve c s) as [order|[]] eqn:E, (resolve c s') as [order'|[]] eqn:E'; simpl; try tauto.
  split.
  - intros x p. rewrite (each_property_is_determined_by_its_non_optional_specifier_else_its_optional_one_else_its_default c s order E).
    rewrite (each_property_is_determined_by_its_non_optional_specifier_else_its_optional_one_else_its_default c s' order' E').
    split; apply determines_permuted; auto. now symmetry.
  - intros value evaluate. destruct R as (Once & Opt & _ & _ & A), R' as (_ & _ & _ & _ & A').
    apply (admissible_orders_agree value evaluate c s); auto.
Qed.

(** * Examples *)

(** The paper's [Car left of 0 @ 0, facing roadDirection]; position, heading and width are 0, 1 and 2. *)
Example left_of_a_vector_and_facing_a_field_have_cyclic_dependencies :
  let left_of := Specifier 0 [0] [] [1; 2] in
  let facing := Specifier 1 [1] [] [0] in
  resolve [[(2, Expression 0 [])]] [left_of; facing] = Failed (CyclicDependencies [Written left_of; Written facing]).
Proof. reflexivity. Qed.

Example what_the_error_is_about_may_depend_on_the_order_of_the_source :
  let a := Specifier 0 [1; 2] [] [] in
  let b := Specifier 1 [1] [] [] in
  let c := Specifier 2 [2] [] [] in
  resolve [] [a; b; c] = Failed (SpecifiedTwice 1 (Written a) (Written b)) /\
  resolve [] [a; c; b] = Failed (SpecifiedTwice 2 (Written a) (Written c)).
Proof. split; reflexivity. Qed.
