"""The nets of segnet.py and gcn.py in torch and torch_geometric: rivals of bench.py, which runs without them."""

import numpy as np
import torch
import torch.nn.functional as F

from gnl import gcn, segnet

try:
    from torch_geometric.nn import GCNConv, global_mean_pool
except ImportError:
    GCNConv = None

torch.set_num_threads(1)


class TorchNet:
    """segnet.py's net with torch's functions."""

    def __init__(self, params):
        self.p = {name: torch.tensor(p) for name, p in params.items()}
        w = segnet.WIDTH
        # Torch has the pixels of a quad and the quads of a square innermost, or as a kernel of 2 x 2.
        self.p["stem.w"] = self.p["stem.w"].reshape(segnet.QUAD, 3, w).transpose(0, 1).reshape(-1, w)
        self.p["down.w"] = self.p["down.w"].reshape(2, 2, w, w)
        for name in ("up.w", "up.b"):
            p = self.p[name]
            self.p[name] = p.unflatten(-1, (segnet.QUAD, w)).transpose(-1, -2).reshape(p.shape)
        for name, p in self.p.items():  # (C, F) and (h, w, C, F) as torch has them: (F, C, h, w)
            if name.endswith(".w"):
                p = (p[None, None] if p.ndim == 2 else p).permute(3, 2, 0, 1).contiguous()
            self.p[name] = p.requires_grad_()

    def forward(self, rgb):
        """Scores (B, 10, 64, 64)."""
        x = torch.from_numpy(rgb).permute(0, 3, 1, 2).float()
        x = (x - segnet.MEAN) / segnet.SPREAD
        height = torch.linspace(1, -1, x.shape[2] // 2)[None, None, :, None]

        def conv(name, x, padding=0, stride=1):
            return F.conv2d(x, self.p[f"{name}.w"], self.p.get(f"{name}.b"), stride, padding)

        fine = F.relu(conv("stem", F.pixel_unshuffle(x, 2)) + conv("height", height))
        x = F.relu(conv("down", fine, 0, 2))
        x = F.relu(x + conv("block0.second", F.relu(conv("block0.first", x, 1)), 1))
        y = conv("pyramid", x)
        for grid in segnet.GRIDS:
            cells = x.shape[2] // grid
            y = y + F.interpolate(conv(f"pyramid{grid}", F.avg_pool2d(x, cells)), scale_factor=cells)
        joined = F.relu(conv("fine", fine) + F.pixel_shuffle(conv("up", F.relu(y)), 2))
        return F.pixel_shuffle(conv("head", joined), 2)

    def scores(self, rgb):
        with torch.no_grad():
            return self.forward(rgb)

    def gradients(self, rgb, labels):
        target = torch.from_numpy(segnet.from_quads(labels))
        return torch.autograd.grad(F.cross_entropy(self.forward(rgb), target), list(self.p.values()))


class TorchGCN:
    """gcn.py's network twice: as layers of torch_geometric, and with padded dense matrices."""

    def __init__(self, ours, graphs, places):
        self.p = {name: torch.tensor(p, requires_grad=True) for name, p in ours.params.items()}
        self.adam, self.places = torch.optim.Adam(self.p.values(), 0.001), torch.from_numpy(places)
        size = np.diff(graphs.starts)
        self.A, self.words = np.zeros((32, size.max(), size.max()), np.float32), np.zeros((32, size.max()), int)
        self.mask, self.graphs = np.arange(size.max()) < size[:, None], []
        for b in range(32):
            graph, n = graphs[b], size[b]
            self.A[b, :n, :n] = gcn.normalise_adjacency(graph.edges, n).toarray()
            self.words[b, :n] = graph.words
            self.graphs.append(self.tensors(graph))
        self.A, self.words, self.mask = map(torch.from_numpy, (self.A, self.words, self.mask))
        self.batch = self.tensors(graphs)
        if GCNConv:
            self.layers = [GCNConv(*w.shape) for w in (self.p["W1"], self.p["W2"])]

    @staticmethod
    def tensors(graphs):
        """One-hot words, edges in both directions, graph of each node, number of graphs."""
        owner = np.repeat(np.arange(len(graphs)), np.diff(graphs.starts))
        both = np.concatenate([graphs.edges, graphs.edges[:, ::-1]]).T
        one_hot = np.eye(gcn.N_WORDS, dtype=np.float32)[graphs.words]
        return *map(torch.from_numpy, (one_hot, np.ascontiguousarray(both), owner)), len(graphs)

    def scores(self, words, edges, owner, n):
        H1 = self.layers[0](words, edges).relu()
        g = global_mean_pool(self.layers[1](H1, edges).relu(), owner, n)
        return g @ self.p["W3"] + self.p["b3"]

    def one_by_one(self):
        with torch.no_grad():
            return [self.scores(*graph) for graph in self.graphs]

    def at_once(self):
        with torch.no_grad():
            return self.scores(*self.batch)

    def step(self):
        p = self.p
        H1 = (self.A @ F.embedding(self.words, p["W1"]) + p["b1"]).relu()
        H2 = (self.A @ (H1 @ p["W2"]) + p["b2"]).relu() * self.mask[..., None]
        g = H2.sum(1) / self.mask.sum(1, keepdim=True)
        self.adam.zero_grad()
        F.cross_entropy(g @ p["W3"] + p["b3"], self.places).backward()
        self.adam.step()
