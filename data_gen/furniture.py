"""What furniture there is, what belongs in which room and where.

    rule   where a piece goes: at a "wall", in a "corner", near the "middle", anywhere ("free"), or
           "on", "above", "beside", "before", "round", "facing" another piece; "or" gives the second best
"""

PIECES = {  # name: class, then least and most width, depth (away from the wall), height, foot z0; m
    "bed": ("bed", (0.9, 1.9), (1.9, 2.15), (0.35, 0.70), (0.0, 0.0)),
    "sofa": ("sofa", (1.5, 2.5), (0.80, 1.05), (0.65, 0.95), (0.0, 0.0)),
    "armchair": ("sofa", (0.70, 0.95), (0.70, 0.95), (0.65, 1.05), (0.0, 0.0)),
    "tv": ("tv", (0.8, 1.5), (0.05, 0.10), (0.50, 0.85), (0.85, 1.15)),
    "monitor": ("tv", (0.5, 0.8), (0.06, 0.12), (0.35, 0.50), (0.0, 0.0)),
    "refrigerator": ("refrigerator", (0.55, 0.95), (0.60, 0.70), (1.3, 2.0), (0.0, 0.0)),
    "dining table": ("table", (1.0, 1.9), (0.75, 1.0), (0.70, 0.78), (0.0, 0.0)),
    "kitchen table": ("table", (0.7, 1.2), (0.60, 0.80), (0.70, 0.78), (0.0, 0.0)),
    "coffee table": ("table", (0.7, 1.3), (0.45, 0.70), (0.30, 0.50), (0.0, 0.0)),
    "desk": ("table", (1.0, 1.8), (0.55, 0.80), (0.70, 0.80), (0.0, 0.0)),
    "side table": ("table", (0.45, 0.9), (0.26, 0.34), (0.60, 0.90), (0.0, 0.0)),
    "nightstand": ("table", (0.35, 0.55), (0.35, 0.45), (0.40, 0.65), (0.0, 0.0)),
    "chair": ("other", (0.40, 0.50), (0.40, 0.50), (0.80, 1.0), (0.0, 0.0)),
    "wardrobe": ("other", (0.9, 2.4), (0.50, 0.65), (1.7, 2.3), (0.0, 0.0)),
    "hall wardrobe": ("other", (0.6, 1.3), (0.32, 0.42), (1.6, 2.2), (0.0, 0.0)),
    "bookshelf": ("other", (0.6, 1.8), (0.25, 0.40), (0.9, 2.2), (0.0, 0.0)),
    "chest": ("other", (0.7, 1.4), (0.40, 0.50), (0.70, 1.2), (0.0, 0.0)),
    "sideboard": ("other", (1.0, 2.0), (0.38, 0.48), (0.60, 1.0), (0.0, 0.0)),
    "shoe cabinet": ("other", (0.5, 1.2), (0.22, 0.35), (0.70, 1.2), (0.0, 0.0)),
    "tv stand": ("other", (1.0, 1.8), (0.35, 0.45), (0.35, 0.60), (0.0, 0.0)),
    "counter": ("other", (1.2, 2.8), (0.58, 0.65), (0.86, 0.94), (0.0, 0.0)),
    "cabinet": ("other", (0.8, 2.2), (0.30, 0.38), (0.50, 0.75), (1.4, 1.5)),
    "oven": ("other", (0.45, 0.60), (0.35, 0.45), (0.28, 0.40), (0.0, 0.0)),
    "bathtub": ("other", (1.4, 1.7), (0.70, 0.80), (0.50, 0.62), (0.0, 0.0)),
    "shower": ("other", (0.75, 0.95), (0.75, 0.95), (1.9, 2.1), (0.0, 0.0)),
    "toilet": ("other", (0.36, 0.42), (0.55, 0.68), (0.40, 0.85), (0.0, 0.0)),
    "basin": ("other", (0.45, 0.9), (0.40, 0.50), (0.80, 0.90), (0.0, 0.0)),
    "washing machine": ("other", (0.58, 0.62), (0.50, 0.62), (0.83, 0.88), (0.0, 0.0)),
    "mirror": ("other", (0.4, 1.0), (0.02, 0.04), (0.60, 1.0), (1.1, 1.3)),
    "picture": ("other", (0.4, 1.4), (0.02, 0.04), (0.30, 0.80), (1.35, 1.6)),
    "plant": ("other", (0.30, 0.55), (0.30, 0.55), (0.60, 1.8), (0.0, 0.0)),
    "floor lamp": ("other", (0.25, 0.40), (0.25, 0.40), (1.4, 1.8), (0.0, 0.0)),
    "lamp": ("other", (0.15, 0.25), (0.15, 0.25), (0.30, 0.50), (0.0, 0.0)),
    "ceiling lamp": ("other", (0.25, 0.60), (0.25, 0.60), (0.20, 0.40), (1.9, 2.1)),
    "carpet": ("other", (1.2, 2.4), (0.9, 1.7), (0.01, 0.01), (0.0, 0.0)),
}

ROOMS = {  # type: its pieces in order: name, rule, probability. A room needs the first one to be of the type
    "bedroom": (
        ("bed", "wall", 1.0), ("nightstand", "beside bed", 0.9), ("nightstand", "beside bed", 0.6),
        ("wardrobe", "wall", 1.0), ("carpet", "before bed or free", 0.5), ("desk", "wall", 0.5),
        ("chair", "before desk", 0.9), ("chest", "wall", 0.6), ("tv", "on chest or wall", 0.3),
        ("monitor", "on desk", 0.4), ("armchair", "free", 0.3), ("plant", "corner", 0.4),
        ("lamp", "on nightstand", 0.5), ("picture", "above bed or wall", 0.7), ("picture", "wall", 0.4),
        ("mirror", "wall", 0.3), ("ceiling lamp", "middle", 0.5)),
    "living room": (
        ("sofa", "wall", 1.0), ("tv stand", "facing sofa or wall", 0.7),
        ("tv", "on tv stand or facing sofa or wall", 1.0), ("carpet", "before sofa", 0.8),
        ("coffee table", "before sofa", 0.9), ("bookshelf", "wall", 1.0), ("sofa", "wall", 0.5),
        ("sideboard", "wall", 0.6), ("bookshelf", "wall", 0.6), ("dining table", "middle", 0.4),
        *4 * (("chair", "round dining table", 0.7),), ("armchair", "free", 0.7), ("armchair", "free", 0.3),
        ("chest", "wall", 0.4), ("bookshelf", "wall", 0.4), ("plant", "corner", 0.8),
        ("plant", "corner", 0.5), ("floor lamp", "corner", 0.6), ("lamp", "on sideboard", 0.5),
        ("picture", "above sofa or wall", 0.8), *2 * (("picture", "wall", 0.6),),
        ("ceiling lamp", "middle", 0.5)),
    "dining room": (
        ("dining table", "middle", 1.0), *6 * (("chair", "round dining table", 0.7),),
        ("sideboard", "wall", 0.9), ("lamp", "on sideboard", 0.6), ("bookshelf", "wall", 0.5),
        ("chest", "wall", 0.4), ("plant", "corner", 0.6), ("picture", "above sideboard or wall", 0.8),
        ("picture", "wall", 0.4), ("ceiling lamp", "middle", 1.0)),
    "kitchen": (
        ("refrigerator", "corner", 1.0), ("counter", "beside refrigerator or wall", 1.0),
        ("counter", "wall", 0.6), ("cabinet", "above counter", 0.9), ("oven", "on counter", 0.8),
        ("kitchen table", "middle", 0.8), *3 * (("chair", "round kitchen table", 0.8),),
        ("sideboard", "wall", 0.4), ("side table", "wall", 0.4), ("bookshelf", "wall", 0.3),
        ("cabinet", "wall", 0.5), ("picture", "wall", 0.4), ("plant", "corner", 0.2),
        ("ceiling lamp", "middle", 0.5)),
    "bathroom": (
        ("toilet", "wall", 1.0), ("bathtub", "corner", 0.7), ("shower", "corner", 0.7),
        ("basin", "wall", 1.0), ("mirror", "above basin or wall", 0.8),
        ("washing machine", "wall", 0.5), ("chest", "wall", 0.3),
        ("side table", "wall", 0.3), ("cabinet", "wall", 0.4), ("ceiling lamp", "middle", 0.5)),
    "study": (
        ("desk", "wall", 1.0), ("chair", "before desk", 1.0), ("monitor", "on desk", 0.8),
        ("bookshelf", "wall", 1.0), ("bookshelf", "wall", 0.8), ("sofa", "wall", 0.5),
        ("carpet", "middle", 0.4), ("chest", "wall", 0.5), ("armchair", "free", 0.4),
        ("plant", "corner", 0.6), ("lamp", "on desk", 0.4), ("picture", "wall", 0.8),
        ("picture", "wall", 0.4), ("ceiling lamp", "middle", 0.5)),
    "corridor": (
        ("shoe cabinet", "wall", 1.0), ("hall wardrobe", "wall", 0.8), ("side table", "wall", 0.6),
        ("bookshelf", "wall", 0.4), ("lamp", "on side table", 0.5), ("mirror", "wall", 0.6),
        *2 * (("picture", "wall", 0.6),), ("plant", "corner", 0.3), ("ceiling lamp", "middle", 0.5)),
}
