"""Which vehicle may go on: parts of the layout are held by one vehicle at a time, and never so that vehicles wait for each other.

Each vehicle has a home that no other vehicle's route passes, and a route that ends there. A further part is granted if no other
vehicle is on a part in conflict with it, and if afterwards there is still an order of moves by which all vehicles come home (the
banker's algorithm of Dijkstra, for parts instead of money, in steps from node to node). That order is kept until another one is found,
and its first move is always granted. So there is always a vehicle that may go on.

Plain values and no clock: the same calls lead to the same grants.
"""


class Traveller:
    """A vehicle of the traffic.

    home   its node
    route  nodes from the one that it was at when the route was made, to its home
    base   index in the route of the last node that is granted
    at     index of the last node that it has passed
    """
    def __init__(self, node, home):
        self.home = home
        self.route, self.base, self.at = [node], 0, 0
        self.held = 0   # parts, as bits
        self.needs = [0]  # from each index of the route on: the conflicts of all parts behind it, as bits


class Traffic:
    def __init__(self, layout):
        self.layout = layout
        self.travellers = {}
        self.plan = []  # names, a move each, by which all come home; the first one last

    def add(self, name, node, home):
        """A vehicle at a node. False if another one is there, or the home is on another one's way."""
        bits = self.layout.conflicts[node]
        if any(other.held & bits or self.layout.conflicts[home] >> other.home & 1 for other in self.travellers.values()):
            return False
        traveller = self.travellers[name] = Traveller(node, home)
        self._hold(traveller)
        return True

    def homes_of_others(self, name):
        """Parts in conflict with them, as bits."""
        bits = 0
        for other, traveller in self.travellers.items():
            if other != name:
                bits |= self.layout.conflicts[traveller.home]
        return bits

    def find_route(self, name, stops):
        """From the end of the granted route over the stops to the home, and the indices of the stops; None if there is none."""
        traveller, forbidden = self.travellers[name], self.homes_of_others(name)
        route, indices = [traveller.route[traveller.base]], []
        for stop in [*stops, traveller.home]:
            leg = self.layout.route(route[-1], stop, forbidden)
            if leg is None:
                return None
            route += leg[1:]
            indices.append(len(route) - 1)
        return route, indices[:-1]

    def relocate(self, name, node):
        """The vehicle is at that node, whatever was granted to it, and has a route home from there."""
        traveller = self.travellers[name]
        traveller.route = self.layout.route(node, traveller.home, self.homes_of_others(name)) or [node]
        traveller.base = traveller.at = 0
        traveller.needs = self._needs_of(traveller)
        self._hold(traveller)
        self.plan = self._find_plan() or []

    def take_route(self, name, route):
        """Replaces the part of the route that is not granted. False, without effect, if vehicles could come to wait for each other."""
        traveller = self.travellers[name]
        before = traveller.route, traveller.base, traveller.at, traveller.needs
        traveller.route = traveller.route[:traveller.base] + route
        traveller.needs = self._needs_of(traveller)
        if self.is_safe():
            return True
        traveller.route, traveller.base, traveller.at, traveller.needs = before
        return False

    def start_here(self, name):
        """The route begins at the end of its granted part, where the vehicle is."""
        traveller = self.travellers[name]
        traveller.route, traveller.needs = traveller.route[traveller.base:], traveller.needs[traveller.base:]
        traveller.at = traveller.base = 0
        self._hold(traveller)

    def pass_node(self, name, index):
        """The vehicle has passed the nodes up to that one, and given those behind it back."""
        traveller = self.travellers[name]
        traveller.at = max(traveller.at, min(index, traveller.base))
        self._hold(traveller)

    def extend(self, name, last):
        """Grants one more node of the route, up to that index. False: it has to wait."""
        traveller = self.travellers[name]
        if traveller.base >= min(last, len(traveller.route) - 1):
            return False
        part = traveller.route[traveller.base + 1]
        bits = self.layout.conflicts[part] | self.layout.conflicts[self.layout.edges[traveller.route[traveller.base], part]]
        if any(other.held & bits for each, other in self.travellers.items() if each != name):
            return False
        traveller.base += 1
        self._hold(traveller)
        if self.plan and self.plan[-1] == name:
            self.plan.pop()
            return True
        if self.is_safe():
            return True
        traveller.base -= 1
        self._hold(traveller)
        return False

    def is_safe(self):
        """Whether there is an order of moves by which all vehicles come home. It is kept: its first move may always be granted."""
        plan = self._find_plan()
        if plan is None:
            return False
        self.plan = plan
        return True

    def _find_plan(self):
        """Names, a move to the next node each, the first one last; None if none was found. All vehicles are at the ends of what they
        were granted: one that can come home at once goes there; else one goes as far as it can."""
        conflicts, edges = self.layout.conflicts, self.layout.edges
        left = sorted(self.travellers)
        at = {name: self.travellers[name].base for name in left}
        own = {name: 1 << self.travellers[name].route[at[name]] for name in left}
        taken, moves = 0, []
        for bit in own.values():
            taken |= bit
        while left:
            stays = []
            for name in left:
                traveller = self.travellers[name]
                if taken & ~own[name] & traveller.needs[at[name]]:
                    stays.append(name)
                else:
                    # At home it is in no other vehicle's way.
                    moves += [name] * (len(traveller.route) - 1 - at[name])
                    taken &= ~own[name]
            if len(stays) == len(left):
                for name in left:
                    route, begin = self.travellers[name].route, at[name]
                    others = taken & ~own[name]
                    while at[name] + 1 < len(route):
                        start, end = route[at[name]], route[at[name] + 1]
                        if others & (conflicts[end] | conflicts[edges[start, end]]):
                            break
                        at[name] += 1
                    if at[name] > begin:
                        own[name] = 1 << route[at[name]]
                        taken = others | own[name]
                        moves += [name] * (at[name] - begin)
                        break
                else:
                    return None
            left = stays
        return moves[::-1]

    def _needs_of(self, traveller):
        needs, bits = [0] * len(traveller.route), 0
        for i in range(len(traveller.route) - 1, 0, -1):
            bits |= self.layout.conflicts[traveller.route[i]]
            bits |= self.layout.conflicts[self.layout.edges[traveller.route[i - 1], traveller.route[i]]]
            needs[i - 1] = bits
        return needs

    def _hold(self, traveller):
        bits = 0
        for i in range(traveller.at, traveller.base + 1):
            bits |= 1 << traveller.route[i]
            if i > traveller.at:
                bits |= 1 << self.layout.edges[traveller.route[i - 1], traveller.route[i]]
        traveller.held = bits
